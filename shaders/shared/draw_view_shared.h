// SPDX-License-Identifier: MIT
#ifndef DRAW_VIEW_SHARED_H
#define DRAW_VIEW_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** Content of `view_block`. */
struct ViewData {
  mat4 clip_from_world;
  mat4 world_from_clip;
  /** Position of the eye, world space, metres. Unused by an orthographic projection. */
  vec3 position_ws;
  /** 1 for a perspective projection, 0 for an orthographic one. */
  int is_perspective;
  /** Unit vector opposite to the view direction. */
  vec3 back_ws;
  /** Added to the mip level of material textures, because several samples per pixel resolve smaller texels. */
  float texture_lod_bias;
};
SHARED_ASSERT_SIZE(ViewData, 160)

SHARED_END

#endif
