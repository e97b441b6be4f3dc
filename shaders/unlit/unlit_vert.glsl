#version 450 core
// SPDX-License-Identifier: MIT
#include "draw/draw_object_lib.glsl"
#include "draw/draw_view_lib.glsl"
#if defined(USE_FULL_MATERIAL)
#  include "eevee/eevee_full_material_vert_lib.glsl"
#elif defined(USE_BASE_COLOR_TEXTURE)
#  include "eevee/eevee_base_color_vert_lib.glsl"
#else
layout(location = 2) flat out uint surface_material;
#endif
#ifdef USE_DEPTH_CAMERA
#  include "unlit/unlit_depth_camera_lib.glsl"

layout(location = 0) out vec4 depth_camera_position;
#endif

void main()
{
  vec4 position_ws = vertex_position_ws();
  gl_Position = view.clip_from_world * position_ws;
#if defined(USE_FULL_MATERIAL) || defined(USE_BASE_COLOR_TEXTURE)
  write_material_varyings();
#  ifdef USE_FULL_MATERIAL
  write_full_varyings();
#  endif
#else
  surface_material = object_value();
#endif
#ifdef USE_DEPTH_CAMERA
  depth_camera_position = clip_from_world * position_ws;
#endif
}
