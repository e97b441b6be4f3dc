// SPDX-License-Identifier: MIT
// For fragment shaders: the texture of the surface's base colour, and what its alpha cuts out.
#include "eevee/eevee_material_lib.glsl"

layout(location = 3) in vec2 surface_uv;

layout(binding = BASE_COLOR_SLOT) uniform sampler2D base_color_texture;

vec3 base_color_tint()
{
  return texture(base_color_texture, surface_uv).rgb;
}

/**
 * Always at full size: the means of mip-maps thin out what is far away, where samples add up to the right coverage, and
 * every pass decides alike whatever its view.
 */
bool is_cut_out(float mask_cutoff)
{
  return mask_cutoff > 0.0 && textureLod(base_color_texture, surface_uv, 0.0).a < mask_cutoff;
}
