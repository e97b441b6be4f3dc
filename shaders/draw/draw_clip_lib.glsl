// SPDX-License-Identifier: MIT
// For fragment shaders: whether the clip planes of the view leave this fragment out. The position follows from the depth, so that
// passes with an equal-depth test need no planes.
#include "shared/draw_view_shared.h"
#include "shared/slots_shared.h"

layout(std140, binding = CLIP_BLOCK_SLOT) uniform clip_block
{
  ClipData clip;
};

bool is_clipped()
{
  for (int i = 0; i < 6; i++) {
    if (dot(clip.planes[i], vec4(gl_FragCoord.xyz, 1.0)) < 0.0) {
      return true;
    }
  }
  return false;
}
