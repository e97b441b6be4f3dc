#version 450 core
// SPDX-License-Identifier: MIT
// The same as eevee_shadow_layered_vert.glsl, for devices whose vertex shaders cannot select the layer. The geometry shader
// selects it.
#include "eevee/eevee_shadow_render_lib.glsl"

layout(location = 9) flat out int caster_layer;

void main()
{
  place_caster();
  caster_layer = int(draw_instance.y);
}
