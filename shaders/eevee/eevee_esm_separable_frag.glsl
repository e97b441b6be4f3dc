#version 450 core
// SPDX-License-Identifier: MIT
// One of the two passes of a Gaussian over the map's texels: along its rows, then along its columns into the layer.
#include "eevee/eevee_esm_block_lib.glsl"
#include "shared/eevee_octahedral_shared.h"

/** Distances, metres, without a border. */
layout(binding = ESM_SOURCE_SLOT) uniform sampler2D esm_source;

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** Index in `esm_block`. */
  int lamp;
  /** 0: along rows, metres without a border; 1: along columns, as the layer stores it, with one. */
  int axis;
};

#ifdef EVSM
/** With a distance its relative variance, 0 before the first pass. */
layout(location = 0) out vec2 result;
#else
layout(location = 0) out float result;
#endif

float source_distance(ivec2 texel)
{
  return texelFetch(esm_source, texel, 0).r;
}

#ifdef EVSM
/** Mean of squares of what a row's texel is the mean of, by the mean's square. */
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
  // A disk's variance across is a quarter of its radius' square. In texels: those here, so that the solid angle is the same everywhere.
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
    // The map goes on past its edges turned by 180°: a row stays a row.
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
