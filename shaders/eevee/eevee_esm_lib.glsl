// SPDX-License-Identifier: MIT
// Visibility of a lamp, 1 lit and 0 in shadow, from its octahedral layer.
#include "eevee/eevee_esm_block_lib.glsl"
#include "shared/eevee_octahedral_shared.h"

/** All arrays are bound. EsmData::format selects the array of a lamp's layer. */
layout(binding = SHADOW_ESM_SLOT) uniform sampler2DArray shadow_esm;
layout(binding = SHADOW_ESM_HALF_SLOT) uniform sampler2DArray shadow_esm_half;
#ifdef USE_SHADOW_EVSM
layout(binding = SHADOW_EVSM_SLOT) uniform sampler2DArray shadow_evsm;
#endif

/** The four texels around \a uv of the map, metres. \a fraction: position of \a uv between their centres. */
vec4 esm_gathered(sampler2DArray layers, EsmData data, vec2 uv, out vec2 fraction)
{
  vec2 texel = uv * float(data.size) + (float(ESM_BORDER) - 0.5);
  vec2 low = floor(texel);
  fraction = texel - low;
  // Gather at the corner that the four texels share, so that rounding cannot select other texels.
  vec2 corner = (low + 1.0) / vec2(textureSize(layers, 0).xy);
  return textureGather(layers, vec3(corner, float(data.layer)));
}

#ifdef USE_SHADOW_EVSM
/** The variances of the same four texels. */
vec4 esm_gathered_variance(EsmData data, vec2 uv)
{
  vec2 low = floor(uv * float(data.size) + (float(ESM_BORDER) - 0.5));
  vec2 corner = (low + 1.0) / vec2(textureSize(shadow_evsm, 0).xy);
  return textureGather(shadow_evsm, vec3(corner, float(data.layer)), 1);
}
#endif

/**
 * Visibility of the lamp, in [0, 1] for every input; 1 at the lamp itself.
 *
 * index: index in `esm_block`. from_light_ws: from the lamp to the receiver, metres. normal_ws: unit normal of the receiver's
 * plane, on either side.
 */
float shadow_esm_visibility(int index, vec3 from_light_ws, vec3 normal_ws)
{
  EsmData data = esm.lamps[index];
  // Compute the length without squares that overflow or underflow.
  vec3 v = clamp(from_light_ws, -1e30, 1e30);
  float largest = max(max(abs(v.x), abs(v.y)), abs(v.z));
  v /= max(largest, 1e-30);
  float norm = sqrt(dot(v, v));
  vec3 direction = v / max(norm, 1e-30);
  // Empty texels store the range, so receivers beyond it are clamped to it.
  float distance = min(largest * norm, data.range);
  float texel_angle = octahedral_texel_angle(direction, data.size);
  float bias = esm_bias(distance, dot(normal_ws, direction), texel_angle, esm_format_error(data.range, data.format));
  vec2 uv = octahedral_from_direction(v);
  vec2 fraction;
#ifdef USE_SHADOW_EVSM
  if (data.format == ESM_VARIANCE) {
    vec4 means = esm_gathered(shadow_evsm, data, uv, fraction);
    float bound = esm_gathered_variance_visibility(data.exponent, means, esm_gathered_variance(data, uv),
                                                   distance - data.bias * bias, 2.0 * texel_angle * distance, fraction);
    return bound >= 0.0 ? min(bound, 1.0) : 1.0;
  }
#endif
  vec4 stored = data.format == ESM_HALF ? esm_gathered(shadow_esm_half, data, uv, fraction) :
                                          esm_gathered(shadow_esm, data, uv, fraction);
  stored = vec4(esm_decoded(stored.x, data.range, data.format), esm_decoded(stored.y, data.range, data.format),
                esm_decoded(stored.z, data.range, data.format), esm_decoded(stored.w, data.range, data.format));
  float visibility = esm_gathered_visibility(data.exponent, stored, distance - data.bias * bias, fraction);
  // A comparison with NaN is false, which gives 1.
  return visibility >= 0.0 ? min(visibility, 1.0) : 1.0;
}
