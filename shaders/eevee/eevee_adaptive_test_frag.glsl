#version 450 core
// SPDX-License-Identifier: MIT
// Finds the pixels of the film that need no more samples: those that differ little from the eight around them. Writes depth 1 for
// them, otherwise 0.
#include "shared/slots_shared.h"

layout(binding = RADIANCE_SLOT) uniform sampler2D film;

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** Factor from the film to the mean of its samples. */
  float sample_scale;
  /** Settings::noise_threshold */
  float threshold;
};

void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 low = texelFetch(film, pixel, 0);
  vec4 high = low;
  for (int y = -1; y <= 1; y++) {
    for (int x = -1; x <= 1; x++) {
      vec4 texel = texelFetch(film, clamp(pixel + ivec2(x, y), ivec2(0), textureSize(film, 0) - 1), 0);
      low = min(low, texel);
      high = max(high, texel);
    }
  }
  high *= sample_scale;
  vec4 difference = high - low * sample_scale;
  // A difference is as visible as its ratio to the square root of the brightness.
  float largest = max(difference.r, max(difference.g, difference.b));
  float brightest = max(high.r, max(high.g, high.b));
  bool is_converged = largest * largest <= threshold * threshold * brightest && difference.a <= threshold;
  gl_FragDepth = is_converged ? 1.0 : 0.0;
}
