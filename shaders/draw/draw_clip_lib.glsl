// SPDX-License-Identifier: MIT
// For fragment shaders: whether the clip planes of the view leave this fragment out. The position follows from the depth, so that
// passes with an equal-depth test need no planes.
#include "draw/draw_view_lib.glsl"

bool is_clipped()
{
  for (int i = 0; i < 6; i++) {
    if (dot(view.clip_planes[i], vec4(gl_FragCoord.xyz, 1.0)) < 0.0) {
      return true;
    }
  }
  return false;
}
