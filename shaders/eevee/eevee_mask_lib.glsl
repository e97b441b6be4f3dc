// SPDX-License-Identifier: MIT
// For fragment shaders: alpha masks in the picture.
#include "draw/draw_view_lib.glsl"
#include "eevee/eevee_alpha_lib.glsl"
#include "shared/eevee_sequence_shared.h"

/**
 * In (0, 1). Neighbouring pixels, and the samples of one, are spread evenly, as those of opacity_threshold. Surfaces of different
 * depths are independent, so that one does not hide behind the covered pixels of another.
 */
float mask_threshold()
{
  uint lattice = 3242174889u * uint(gl_FragCoord.x) + 2447445414u * uint(gl_FragCoord.y);
  uint depth_slab = floatBitsToUint(gl_FragCoord.z) >> 16u;
  float threshold = fract(to_unit(lattice + mixed_bits(depth_slab)) + view.mask_shift);
  return clamp(threshold, 1.0 / 512.0, 511.0 / 512.0);
}

/**
 * is_cut_out in a pixel. Where the pixel is larger than texels and the mask is the same all around it, the pixel is covered as often as
 * the texels in it: levels above 0 of a mask's texture store the covered share. At the edge of a shape that is larger than the pixel, a
 * look-up of level 0 has half of the error, and the right mean. What is the same is compared over 4 and 16 pixels: within one pixel, a
 * weight that follows the mask's own pattern would change the mean.
 */
bool is_pixel_cut_out(float mask_cutoff)
{
  if (mask_cutoff <= 0.0) {
    return false;
  }
  float factor = 1.0;
#ifdef USE_FULL_MATERIAL
  factor = surface_color.a;
  if (!has_input(INPUT_BASE_COLOR)) {
    return factor < mask_cutoff;
  }
#endif
  bool is_open = factor * textureLod(base_color_texture, surface_uv, 0.0).a < mask_cutoff;
  // x: the level that the sampler reads, which is 0 without mip levels. y: the level by size.
  vec2 lod = textureQueryLod(base_color_texture, surface_uv);
  // Samples are spread by a filter that is wider than a pixel, so that a few of them fall on one side of a pixel. Shares are those of twice
  // the distance between samples, and at most of a pixel.
  float level = lod.y + min(view.texture_lod_bias + 1.0, 0.0);
  // The image itself, of level 0, has colors of texels that are cut out.
  float has_levels = clamp(4.0 * (lod.y + view.texture_lod_bias) - 3.0, 0.0, 1.0);
  if (lod.x <= 0.0 || has_levels <= 0.0 || factor < mask_cutoff) {
    return is_open;
  }
  float share = textureLod(base_color_texture, surface_uv, max(level, 1.0)).a;
  float share_around = textureLod(base_color_texture, surface_uv, level + 2.0).a;
  float share_farther = textureLod(base_color_texture, surface_uv, level + 4.0).a;
  // The levels are rounded to 1/255.
  float weight = has_levels * clamp(2.0 - 64.0 * abs(share_around - share_farther), 0.0, 1.0);
  return mix(is_open ? 0.0 : 1.0, share, weight) < mask_threshold();
}
