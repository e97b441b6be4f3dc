// SPDX-License-Identifier: MIT
// For fragment shaders: the base colour texture and vertex colours of a full material, and its alpha mask.
#include "eevee/eevee_full_block_lib.glsl"
#include "eevee/eevee_grid_lib.glsl"
#include "eevee/eevee_material_lib.glsl"

INTERPOLATED(3, vec2, surface_uv, grid_uv)
layout(location = 4) in vec4 surface_color;

layout(binding = BASE_COLOR_SLOT) uniform sampler2D base_color_texture;

/** The material is constant over a triangle, so branches on it keep the derivatives of texture coordinates defined. */
bool has_input(uint input_bit)
{
  return (full_materials[surface_material].inputs & input_bit) != 0u;
}

/** Opacity of a blended surface in [0, 1]. \a texel: alpha of its base colour texture. */
float blended_opacity(float texel)
{
  return clamp(full_materials[surface_material].opacity * surface_color.a * texel, 0.0, 1.0);
}

/** The same as is_cut_out of eevee_base_color_lib.glsl. The alpha is multiplied by that of the vertex colour. */
bool is_cut_out(float mask_cutoff)
{
  if (mask_cutoff <= 0.0) {
    return false;
  }
  float alpha = surface_color.a;
  if (has_input(INPUT_BASE_COLOR)) {
    alpha *= textureLod(base_color_texture, surface_uv, 0.0).a;
  }
  return alpha < mask_cutoff;
}
