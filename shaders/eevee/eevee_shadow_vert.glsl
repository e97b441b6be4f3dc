#version 450 core
// SPDX-License-Identifier: MIT
#include "draw/draw_object_lib.glsl"
#include "shared/eevee_shadow_shared.h"
#ifdef USE_ALPHA_MASK
#  include "eevee/eevee_base_color_vert_lib.glsl"
#endif

layout(std140, binding = SHADOW_RENDER_BLOCK_SLOT) uniform shadow_render_block
{
  ShadowRenderBlock shadow_render;
};

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  int shadow_face;
};

void main()
{
  gl_Position = shadow_render.clip_from_world[shadow_face] * vertex_position_ws();
#ifdef USE_ALPHA_MASK
  hand_on_base_color();
#endif
}
