#version 450 core
// SPDX-License-Identifier: MIT
#include "draw/draw_object_lib.glsl"
#include "draw/draw_view_lib.glsl"
#include "eevee/eevee_grid_vert_lib.glsl"
#ifdef USE_ALPHA_MASK
#  include "eevee/eevee_alpha_vert_lib.glsl"
#endif

// The lit pass tests for equal depth, so both passes must compute the same position.
invariant gl_Position;

void main()
{
  vec4 position_ws = vertex_position_ws();
  gl_Position = placed_vertex(view.clip_from_world, position_ws, 2.0 / vec2(view.place_right.w, view.place_up.w));
#ifdef USE_ALPHA_MASK
  write_alpha_varyings(position_ws.xyz);
#endif
}
