// SPDX-License-Identifier: MIT
// For fragment shaders: where alpha masks are looked up.
#ifndef WITHOUT_VIEW
#  include "draw/draw_view_lib.glsl"
#endif

/**
 * Coordinates of the lookup, in level 0, of a mask that is seen at \a uv. Mip-mapped alpha would thin out distant surfaces. Where
 * texels are smaller than the part of the pixel for which a sample stands, the lookup is at another place of that part in each of
 * 16 x 16 pixels, so that the covered part of these pixels is that of the mask, whatever the distance of texels and pixels. All
 * passes of a view find the same place. Shadow layers, which have no view, look up the middle.
 */
vec2 mask_uv(sampler2D mask, vec2 uv)
{
#ifdef WITHOUT_VIEW
  return uv;
#else
  float part = exp2(view.texture_lod_bias);
  vec2 across = part * dFdx(uv);
  vec2 up = part * dFdy(uv);
  vec2 size = vec2(textureSize(mask, 0));
  bool is_minified = max(dot(across * size, across * size), dot(up * size, up * size)) > 1.0;
  // Odd factors reorder the 16 columns and rows, so that neighbours are far apart.
  uvec2 pixel = uvec2(gl_FragCoord.xy);
  uvec2 coarse = uvec2(7u, 11u) * pixel & 15u;
  uvec2 fine = uvec2(5u, 3u) * pixel.yx & 15u;
  vec2 place = (vec2(16u * coarse + fine) + 0.5) / 256.0 - 0.5;
  return is_minified ? uv + place.x * across + place.y * up : uv;
#endif
}
