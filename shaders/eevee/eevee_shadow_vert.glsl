#version 450 core
// SPDX-License-Identifier: MIT
// Draws one layer in each pass.
#include "eevee/eevee_shadow_render_lib.glsl"

void main()
{
  place_caster();
}
