// SPDX-License-Identifier: MIT
// Where the lines are drawn.
#include "shared/slots_shared.h"

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  mat4 clip_from_world;
  /** Lower left corner of the picture in the target. */
  ivec2 origin_px;
  ivec2 picture_size_px;
};
