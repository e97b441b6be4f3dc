#version 450 core
// SPDX-License-Identifier: MIT
// The object at each pixel, and its depth.
#ifdef USE_ALPHA_MASK
#  include "eevee/eevee_alpha_lib.glsl"
#endif
#include "draw/draw_clip_lib.glsl"

layout(location = 0) flat in uint surface_object;

/** x: index in object_block, which a float holds exactly below 2^24. y: depth. */
layout(location = 0) out vec2 object_depth;

void main()
{
  object_depth = vec2(float(surface_object), gl_FragCoord.z);
#ifdef USE_ALPHA_MASK
  if (is_cut_out(materials[surface_material].mask_cutoff)) {
    discard;
  }
#endif
  discard_clipped();
}
