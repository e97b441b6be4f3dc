// SPDX-License-Identifier: MIT
// For vertex shaders: writes the inputs of eevee_surface_frag_lib.glsl.
#include "draw/draw_object_lib.glsl"

layout(location = ATTRIBUTE_NORMAL) in vec3 normal;

layout(location = 0) out vec3 surface_position_ws;
layout(location = 1) out vec3 surface_normal_ws;

void write_surface_varyings(vec3 position_ws)
{
  surface_position_ws = position_ws;
  vec3 normal_ws = to_normal_ws(normal);
  float length_sq = dot(normal_ws, normal_ws);
  surface_normal_ws = length_sq > 0.0 ? normal_ws * inversesqrt(length_sq) : vec3(0.0);
}
