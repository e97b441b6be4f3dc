#version 450 core
#extension GL_ARB_shader_viewport_layer_array : require
// SPDX-License-Identifier: MIT
// All layers of a lamp in one pass: each instance says which is its own.
#include "eevee/eevee_shadow_render_lib.glsl"

void main()
{
  gl_Position = caster_position_cs();
  gl_Layer = int(draw_instance.y);
}
