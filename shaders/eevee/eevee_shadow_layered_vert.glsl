#version 450 core
#extension GL_ARB_shader_viewport_layer_array : require
// SPDX-License-Identifier: MIT
// Draws all layers of a lamp in one pass. The value of each instance is its layer.
#include "eevee/eevee_shadow_render_lib.glsl"

void main()
{
  place_caster();
  gl_Layer = int(draw_instance.y);
}
