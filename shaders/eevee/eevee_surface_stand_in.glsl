// SPDX-License-Identifier: MIT
// Drawn instead of a surface function that does not compile: magenta that needs no light.

void surface(SurfaceInputs inputs, inout StandardSurface result)
{
  result.base_color = vec3(1.0, 0.0, 1.0);
  result.metallic = 0.0;
  result.specular = 0.0;
  result.emission = vec3(1.0, 0.0, 1.0);
  result.alpha = 1.0;
}
