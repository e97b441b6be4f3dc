#version 450 core
// SPDX-License-Identifier: MIT
#include "draw/draw_object_lib.glsl"
#include "draw/draw_view_lib.glsl"
#ifdef USE_ALPHA_MASK
#  include "eevee/eevee_alpha_vert_lib.glsl"
#endif

layout(location = 0) flat out uint surface_object;

void main()
{
  gl_Position = view.clip_from_world * vertex_position_ws();
  surface_object = draw_instance.x;
#ifdef USE_ALPHA_MASK
  write_material_varyings();
#endif
}
