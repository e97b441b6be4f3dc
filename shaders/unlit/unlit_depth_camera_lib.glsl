// SPDX-License-Identifier: MIT
// The depth camera.
#include "shared/slots_shared.h"

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** Of the depth camera. */
  mat4 clip_from_world;
  /** A surface is shadowed where it is farther than the stored depth by more than x times its depth, plus y: rounding. */
  vec2 depth_tolerance;
};
