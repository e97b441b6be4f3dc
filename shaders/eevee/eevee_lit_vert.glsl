#version 450 core
// SPDX-License-Identifier: MIT
#include "draw/draw_object_lib.glsl"
#include "draw/draw_view_lib.glsl"
#ifdef USE_BASE_COLOR_TEXTURE
#  include "eevee/eevee_base_color_vert_lib.glsl"
#else
layout(location = 2) flat out uint surface_material;
#endif
#ifdef USE_LIGHT
layout(location = ATTRIBUTE_NORMAL) in vec3 normal;

layout(location = 0) out vec3 surface_position_ws;
layout(location = 1) out vec3 surface_normal_ws;
#endif

invariant gl_Position;

void main()
{
  ObjectData object = objects[draw_instance.x];
  vec4 position_ws = vertex_position_ws();
  gl_Position = view.clip_from_world * position_ws;
#ifdef USE_BASE_COLOR_TEXTURE
  hand_on_base_color();
#else
  surface_material = object.value;
#endif
#ifdef USE_LIGHT
  surface_position_ws = position_ws.xyz;
  vec3 normal_ws = object.normal_x.xyz * normal.x + object.normal_y.xyz * normal.y + object.normal_z * normal.z;
  float length_sq = dot(normal_ws, normal_ws);
  surface_normal_ws = length_sq > 0.0 ? normal_ws * inversesqrt(length_sq) : vec3(0.0);
#endif
}
