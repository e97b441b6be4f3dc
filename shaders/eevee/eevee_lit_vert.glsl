#version 450 core
// SPDX-License-Identifier: MIT
#include "draw/draw_object_lib.glsl"
#include "draw/draw_view_lib.glsl"
#include "eevee/eevee_grid_vert_lib.glsl"
#if defined(USE_FULL_MATERIAL)
#  include "eevee/eevee_full_material_vert_lib.glsl"
#elif defined(USE_BASE_COLOR_TEXTURE)
#  include "eevee/eevee_base_color_vert_lib.glsl"
#else
layout(location = 2) flat out uint surface_material;
#endif
#ifdef USE_LIGHT
#  include "eevee/eevee_surface_vert_lib.glsl"
#endif
#ifdef USE_SURFACE_FUNCTION
#  include "eevee/eevee_surface_function_vert_lib.glsl"
#endif
#ifdef WRITES_OBJECT
layout(location = 9) flat out uint surface_object;
#endif

invariant gl_Position;

void main()
{
  vec4 position_ws = vertex_position_ws();
  gl_Position = placed_vertex(view.clip_from_world, position_ws, 2.0 / vec2(view.place_right.w, view.place_up.w));
#if defined(USE_FULL_MATERIAL) || defined(USE_BASE_COLOR_TEXTURE)
  write_material_varyings();
#  ifdef USE_FULL_MATERIAL
  write_full_varyings();
#  endif
#else
  surface_material = object_value();
#endif
#ifdef USE_LIGHT
  write_surface_varyings(position_ws.xyz);
#endif
#ifdef USE_SURFACE_FUNCTION
  write_function_varyings();
#endif
#ifdef WRITES_OBJECT
  surface_object = draw_instance.x;
#endif
}
