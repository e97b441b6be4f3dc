// SPDX-License-Identifier: MIT
// Stands for the surface function of a material where programs are listed and checked. It changes nothing.

void surface(SurfaceInputs inputs, inout StandardSurface result) {}
