// SPDX-License-Identifier: MIT
// Constants of the depth camera.
#include "shared/slots_shared.h"

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** Matrix of the depth camera. */
  mat4 clip_from_world;
  /** Tolerance for rounding: x is relative to the surface's depth, y is absolute, z is the grid of corners in texels. */
  vec3 depth_tolerance;
};
