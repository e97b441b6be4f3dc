// SPDX-License-Identifier: MIT
// For fragment shaders: the base colour texture of the surface, and its alpha mask.
#include "eevee/eevee_grid_lib.glsl"
#include "eevee/eevee_material_lib.glsl"

INTERPOLATED(3, vec2, surface_uv, grid_uv)

layout(binding = BASE_COLOR_SLOT) uniform sampler2D base_color_texture;

/**
 * Reads level 0, so that the result is the same in every pass, whatever its view. Passes of the picture have is_pixel_cut_out of
 * eevee_mask_lib.glsl.
 */
bool is_cut_out(float mask_cutoff)
{
  return mask_cutoff > 0.0 && textureLod(base_color_texture, surface_uv, 0.0).a < mask_cutoff;
}
