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
 * is_cut_out in a pixel. Where the pixel is larger than texels, it is covered as often as the texels in it: levels above 0 of a mask's
 * texture store the covered share.
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
  float level = textureQueryLod(base_color_texture, surface_uv).y + view.texture_lod_bias;
  float alpha = textureLod(base_color_texture, surface_uv, max(level, 0.0)).a;
  if (level <= 0.0) {
    return factor * alpha < mask_cutoff;
  }
  float share = min(level, 1.0);
  return factor < mask_cutoff || mix(factor, 1.0, share) * alpha < mix(mask_cutoff, mask_threshold(), share);
}
