#version 450 core
// SPDX-License-Identifier: MIT
// One of the two passes of a Gaussian filter over the map: along rows, then along columns into the layer.
#include "eevee/eevee_esm_block_lib.glsl"
#include "shared/eevee_octahedral_shared.h"

/** Input distances, metres, without a border. */
layout(binding = ESM_SOURCE_SLOT) uniform sampler2D esm_source;

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** Index in `esm_block`. */
  int lamp;
  /** 0: along rows, output in metres without a border. 1: along columns, output in the format of the layer, with a border. */
  int axis;
};

#ifdef EVSM
/** Distance and relative variance. The variance is 0 before the first pass. */
layout(location = 0) out vec2 result;
#else
layout(location = 0) out float result;
#endif

float source_distance(ivec2 texel)
{
  return texelFetch(esm_source, texel, 0).r;
}

#ifdef EVSM
/** Mean of the squares of the values that a texel of the first pass averages, divided by the square of their mean. */
float source_square(ivec2 texel)
{
  return axis == 0 ? 1.0 : 1.0 + texelFetch(esm_source, texel, 0).g;
}
#endif

void main()
{
  EsmData data = esm.lamps[lamp];
  int border = axis * ESM_BORDER;
  ivec2 texel = ivec2(gl_FragCoord.xy) - border;
  if (max(texel.x, texel.y) >= data.size + border) {
    discard;
  }
  texel = octahedral_texel(texel, data.size);
  vec3 direction = octahedral_to_direction((vec2(texel) + 0.5) / float(data.size));
  // The variance of a disk along one axis is a quarter of its squared radius. Divided by the texel's angle, so that the solid
  // angle is the same everywhere.
  float deviation = 0.5 * data.filter_angle / octahedral_texel_angle(direction, data.size);
  int reach = int(ceil(3.0 * deviation));
  float falloff = -0.5 / max(deviation * deviation, 1e-30);
  float weights = octahedral_texel_weight(direction);
  LogSum sum = log_sum_begin(source_distance(texel), weights);
#ifdef EVSM
  LogSum squares = log_sum_begin(source_distance(texel), weights * source_square(texel));
#endif
  for (int i = -reach; i <= reach; i++) {
    if (i == 0) {
      continue;
    }
    // The map continues beyond its edges rotated by 180°, so that a row continues as a row.
    ivec2 neighbour = octahedral_texel(axis == 0 ? texel + ivec2(i, 0) : texel + ivec2(0, i), data.size);
    vec3 towards = octahedral_to_direction((vec2(neighbour) + 0.5) / float(data.size));
    float weight = exp(falloff * float(i * i)) * octahedral_texel_weight(towards);
    sum = log_sum_add(sum, data.exponent, source_distance(neighbour), weight);
#ifdef EVSM
    squares = log_sum_add(squares, 2.0 * data.exponent, source_distance(neighbour), weight * source_square(neighbour));
#endif
    weights += weight;
  }
#ifdef EVSM
  float variance = log_sum_variance(sum, squares, weights);
#endif
  sum.sum /= weights;
  float filtered = clamp(log_sum_value(sum, data.exponent), 0.0, data.range);
#ifdef EVSM
  result = vec2(filtered, variance);
#else
  result = axis == 0 ? filtered : esm_encoded(filtered, data.range, data.format);
#endif
}
