#version 450 core
// SPDX-License-Identifier: MIT
// As eevee_shadow_layered_vert.glsl, for devices whose vertex shaders cannot choose the layer: the next stage does.
#include "eevee/eevee_shadow_render_lib.glsl"

layout(location = 0) flat out int caster_layer;

void main()
{
  gl_Position = caster_position_cs();
  caster_layer = int(draw_instance.y);
}
