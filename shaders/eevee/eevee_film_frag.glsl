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

void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  ivec2 last = textureSize(radiance_texture, 0) - 1;
  sum = vec4(0.0);
  for (int y = 0; y < 3; y++) {
    for (int x = 0; x < 3; x++) {
      // Pixels at the edge are repeated where the device has no room for a guard band.
      ivec2 neighbour = clamp(radiance_origin_px + pixel + ivec2(x, y) - 1, ivec2(0), last);
      sum += texelFetch(radiance_texture, neighbour, 0) * (column_weights[x] * row_weights[y]);
    }
  }
}
