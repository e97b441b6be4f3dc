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
 * Offset from the middle of the pixel, within a sample's share of it. \a across, \a up: texels from the middle of the pixel to those of the
 * next ones. Where they are multiples of a twelfth of a texel, the middles of all pixels have a few phases of the mask's pattern, so that
 * its share there is wrong. Elsewhere there is no offset, as it doubles the error at edges.
 */
vec2 mask_offset_px(vec2 across, vec2 up)
{
  vec4 twelfths = 12.0 * vec4(across, up);
  if (any(greaterThan(abs(twelfths - round(twelfths)), vec4(0.05)))) {
    return vec2(0.0);
  }
  // Two lattices that are unlike that of mask_threshold.
  uvec2 pixel = uvec2(gl_FragCoord.xy);
  vec2 place = vec2(to_unit(2654435769u * pixel.x + 1779033703u * pixel.y), to_unit(1395630315u * pixel.x + 3518319155u * pixel.y));
  return (fract(place + view.mask_shift * vec2(1.0, 7.236068)) - 0.5) * exp2(view.texture_lod_bias);
}

/**
 * is_cut_out in a pixel. Where the pixel is larger than texels and the mask is uniform around it, the pixel is covered with the
 * probability that the texture's levels above 0 store, the covered share. Elsewhere, such as at the edge of a shape that is larger than
 * the pixel, the mask at the pixel's middle decides, which has half of the error and the right mean (\see mask_offset_px). A mask is
 * uniform if its shares over 1 pixel, over 4 and over the distance between samples are alike, or if those over 4, 8 and 16 pixels are
 * equal: a weight that varied with the mask's own pattern within a pixel would change the mean. The shares are those of texels that are
 * covered by the material's factor alone: where the alpha of vertices is smaller, others are covered, and each pixel's middle decides.
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
  vec2 texels = vec2(textureSize(base_color_texture, 0));
  vec2 across = dFdx(surface_uv) * texels;
  vec2 up = dFdy(surface_uv) * texels;
  // x: the level that the sampler reads, which is 0 without mip levels. y: the level by size.
  vec2 lod = textureQueryLod(base_color_texture, surface_uv);
  float level = lod.y + view.texture_lod_bias;
  bool is_small = lod.x > 0.0 && level > 0.75;
  // From about two texels in a pixel on: the edge of a larger texel is sharp.
  vec2 offset_px = is_small ? mask_offset_px(across, up) * clamp(12.0 * (level - 0.87), 0.0, 1.0) : vec2(0.0);
  vec2 place_uv = surface_uv + (offset_px.x * across + offset_px.y * up) / texels;
  bool is_open = factor * textureLod(base_color_texture, place_uv, 0.0).a < mask_cutoff;
  // An alpha of vertices of 1 may be below 1 by the rounding of a byte. A smaller one covers other texels than the levels store.
  if (!is_small || factor < 1.0 - 1.0 / 256.0) {
    return is_open;
  }
  // The image itself, of level 0, has colors of texels that are cut out.
  float share = textureLod(base_color_texture, surface_uv, max(level, 1.0)).a;
  // Whether the mask is the same all around does not depend on the number of samples.
  float share_of_pixel = textureLod(base_color_texture, surface_uv, lod.y).a;
  float share_around = textureLod(base_color_texture, surface_uv, lod.y + 2.0).a;
  vec2 shares_farther = vec2(textureLod(base_color_texture, surface_uv, lod.y + 3.0).a,
                             textureLod(base_color_texture, surface_uv, lod.y + 4.0).a);
  float change = max(abs(share_of_pixel - share_around), abs(share - share_around));
  float is_fine = clamp(level - 1.0, 0.0, 1.0) * (1.0 - 24.0 * change);
  // A pattern of several pixels that repeats: its levels differ by their rounding to 1/255 alone. The last levels of a texture are equal for
  // any pattern.
  bool has_farther = lod.y + 5.0 <= float(textureQueryLevels(base_color_texture));
  // Shares of a single shape are equal twice in few places.
  vec2 changes = abs(share_around - shares_farther);
  float is_repeated = has_farther ? min(4.0 * level - 3.0, 1.0) * (2.0 - 256.0 * max(changes.x, changes.y)) : 0.0;
  float weight = clamp(max(is_fine, is_repeated), 0.0, 1.0);
  return mix(is_open ? 0.0 : 1.0, share, weight) < mask_threshold();
}
