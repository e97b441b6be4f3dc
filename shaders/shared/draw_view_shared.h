// SPDX-License-Identifier: MIT
#ifndef DRAW_VIEW_SHARED_H
#define DRAW_VIEW_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** Content of `view_block`. */
struct ViewData {
  mat4 clip_from_world;
  /** Position of the eye, world space, metres. Unused by an orthographic projection. */
  vec3 position_ws;
  /** 1 for a perspective projection, 0 for an orthographic one. */
  int is_perspective;
  /** Unit vector opposite to the view direction. */
  vec3 back_ws;
  /** Added to the mip level of material textures, because several samples per pixel resolve smaller texels. */
  float texture_lod_bias;
  /**
   * The point of the view axis, world space, from which depths in the G-buffer are measured: near the scene, so that they and positions
   * are as precise as those of the scene, however far the eye is.
   */
  vec3 depth_origin_ws;
  /** Distance of depth_origin_ws from the eye along the view axis. 0 in an orthographic view. */
  float depth_origin;
  /**
   * In its xyz, vectors of world space across the view axis, at a distance of 1 from the eye (orthographic: at any). A pixel with the
   * normalized device coordinates (x, y) is at place_middle + x * place_right + y * place_up. The fourth components of the last two are
   * the width and the height of a pixel in these coordinates.
   */
  vec3 place_middle;
  /** In [0, 1), of the sample. \see eevee_mask_lib.glsl */
  float mask_shift;
  vec4 place_right;
  vec4 place_up;
  /**
   * draw::View::clip_planes for the coordinates of fragments: a fragment is shown if the product with vec4(gl_FragCoord.xyz, 1) is at
   * least 0 for all planes.
   */
  vec4 clip_planes[6];
};
SHARED_ASSERT_SIZE(ViewData, 256)

SHARED_END

#endif
