#version 450 core
// SPDX-License-Identifier: MIT
// Adds one sample of the picture to the film by blending. Each pixel adds the samples of the 3x3 pixels around it, weighted by
// the pixel filter.
#include "shared/slots_shared.h"

layout(binding = RADIANCE_SLOT) uniform sampler2D radiance_texture;

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** Weights of the left, middle and right column, and of the lower, middle and upper row. */
  vec4 column_weights;
  vec4 row_weights;
  /** Pixel of the radiance that is the lower left pixel of the picture. */
  ivec2 radiance_origin_px;
};

layout(location = 0) out vec4 sum;

vec4 radiance_at(ivec2 pixel)
{
  // Pixels at the edge are repeated where the device has no room for a guard band.
  return texelFetch(radiance_texture, clamp(pixel, ivec2(0), textureSize(radiance_texture, 0) - 1), 0);
}

void main()
{
  // The four pixels of a quad need 16 texels together. Each pixel fetches its own texel and the three on the outer side
  // of the quad, instead of nine. The differences within the quad give the other five.
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  bvec2 is_odd = bvec2(pixel & 1);
  ivec2 outward = 2 * (pixel & 1) - 1;
  vec2 first_weights = vec2(column_weights.x, row_weights.x);
  vec2 last_weights = vec2(column_weights.z, row_weights.z);
  vec2 outer_weights = mix(first_weights, last_weights, is_odd);
  vec2 inner_weights = mix(last_weights, first_weights, is_odd);
  pixel += radiance_origin_px;
  vec4 own = radiance_at(pixel);
  vec4 outer = radiance_at(pixel + ivec2(outward.x, 0));
  vec4 inner = own - outward.x * dFdxFine(own);
  // Columns, of this row and the outer one.
  vec4 own_column = own * row_weights.y + radiance_at(pixel + ivec2(0, outward.y)) * outer_weights.y;
  vec4 outer_column = outer * row_weights.y + radiance_at(pixel + outward) * outer_weights.y;
  vec4 inner_column = own_column - outward.x * dFdxFine(own_column);
  sum = outer_column * outer_weights.x + own_column * column_weights.y + inner_column * inner_weights.x;
  vec4 own_row = outer * outer_weights.x + own * column_weights.y + inner * inner_weights.x;
  vec4 inner_row = own_row - outward.y * dFdyFine(own_row);
  sum += inner_row * inner_weights.y;
}
