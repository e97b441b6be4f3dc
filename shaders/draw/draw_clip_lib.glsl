// SPDX-License-Identifier: MIT
#ifdef USE_CLIP_PLANES
#  include "draw/draw_view_lib.glsl"
#endif

/**
 * For fragment shaders: discards the fragment if the clip planes of the view leave it out. Its position follows from the depth, so that
 * passes with an equal-depth test need no planes. Does nothing without USE_CLIP_PLANES.
 */
void discard_clipped()
{
#ifdef USE_CLIP_PLANES
  for (int i = 0; i < 6; i++) {
    if (dot(view.clip_planes[i], vec4(gl_FragCoord.xyz, 1.0)) < 0.0) {
      discard;
    }
  }
#endif
}
