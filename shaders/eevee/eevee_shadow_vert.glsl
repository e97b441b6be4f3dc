#version 450 core
// SPDX-License-Identifier: MIT
#include "draw/draw_object_lib.glsl"
#include "shared/eevee_shadow_shared.h"

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
}
