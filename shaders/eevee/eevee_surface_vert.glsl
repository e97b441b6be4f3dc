#version 450 core
// SPDX-License-Identifier: MIT
// The same as eevee_lit_vert.glsl without the material, for the probe and debug programs.
#include "draw/draw_view_lib.glsl"
#include "eevee/eevee_grid_vert_lib.glsl"
#include "eevee/eevee_surface_vert_lib.glsl"

invariant gl_Position;

void main()
{
  vec4 position_ws = vertex_position_ws();
  gl_Position = placed_vertex(view.clip_from_world, position_ws, 2.0 / vec2(view.place_right.w, view.place_up.w));
  write_surface_varyings(position_ws.xyz);
}
