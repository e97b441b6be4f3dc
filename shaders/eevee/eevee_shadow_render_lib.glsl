// SPDX-License-Identifier: MIT
// Where a caster's vertex is in the face, or cascade, that its instance names.
#include "draw/draw_object_lib.glsl"
#include "shared/eevee_shadow_shared.h"

layout(std140, binding = SHADOW_RENDER_BLOCK_SLOT) uniform shadow_render_block
{
  ShadowRenderBlock shadow_render;
};

vec4 caster_position_cs()
{
  return shadow_render.clip_from_world[draw_instance.y] * vertex_position_ws();
}
