#version 450 core
// SPDX-License-Identifier: MIT
// One layer a pass.
#include "eevee/eevee_shadow_render_lib.glsl"

void main()
{
  gl_Position = caster_position_cs();
}
