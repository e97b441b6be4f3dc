// SPDX-License-Identifier: MIT
// For fragment shaders: the base colour texture of the surface, and its alpha mask.
#include "eevee/eevee_mask_lib.glsl"
#include "eevee/eevee_material_lib.glsl"

layout(location = 3) in vec2 surface_uv;

layout(binding = BASE_COLOR_SLOT) uniform sampler2D base_color_texture;

/** The material is constant over a triangle, so that derivatives are defined. */
bool is_cut_out(float mask_cutoff)
{
  return mask_cutoff > 0.0 &&
         textureLod(base_color_texture, mask_uv(base_color_texture, surface_uv), 0.0).a < mask_cutoff;
}
