// SPDX-License-Identifier: MIT
// Positions of the surfaces in the G-buffer.
#include "draw/draw_view_lib.glsl"
#include "shared/eevee_gbuffer_shared.h"

/** Depth beyond view.depth_origin_ws, metres. */
float gbuffer_depth(vec3 position_ws)
{
  return dot(view.depth_origin_ws - position_ws, view.back_ws);
}

/** \a ndc: normalized device coordinates. \a depth: a gbuffer_depth(). */
vec3 gbuffer_position(vec2 ndc, float depth)
{
  vec3 place = view.place_middle + ndc.x * view.place_right.xyz + ndc.y * view.place_up.xyz;
  float scale = view.is_perspective != 0 ? view.depth_origin + depth : 1.0;
  return view.depth_origin_ws + scale * place - depth * view.back_ws;
}
