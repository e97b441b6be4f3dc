// SPDX-License-Identifier: MIT
// For vertex shaders: the position of a caster in a shadow layer (face or cascade). The value of the instance is the layer.
#define DRAW_INSTANCES
#include "draw/draw_object_lib.glsl"
#include "eevee/eevee_grid_vert_lib.glsl"
#include "shared/eevee_shadow_shared.h"
#ifdef USE_ALPHA_MASK
#  include "eevee/eevee_alpha_vert_lib.glsl"
#endif

layout(std140, binding = SHADOW_RENDER_BLOCK_SLOT) uniform shadow_render_block
{
  ShadowRenderBlock shadow_render;
};

void place_caster()
{
  vec4 position_ws = vertex_position_ws();
  gl_Position = placed_vertex(shadow_render.clip_from_world[draw_instance.y], position_ws, vec2(shadow_render.size_px));
#ifdef USE_ALPHA_MASK
  write_alpha_varyings(position_ws.xyz);
#endif
}
