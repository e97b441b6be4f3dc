// SPDX-License-Identifier: MIT
#ifndef DRAW_VIEW_SHARED_H
#define DRAW_VIEW_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** `view_block`. */
struct ViewData {
  mat4 clip_from_world;
  /** World space, metres; unused by a parallel projection. */
  vec3 position_ws;
  int is_perspective;
  /** Unit vector against the view direction. */
  vec3 back_ws;
  float _pad0;
};
SHARED_ASSERT_SIZE(ViewData, 96)

SHARED_END

#endif
