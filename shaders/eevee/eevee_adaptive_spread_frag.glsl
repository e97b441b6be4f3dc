#version 450 core
// SPDX-License-Identifier: MIT
// Finds the pixels of the radiance that only converged pixels of the film read; the pixel filter reads 3x3. Writes depth 1 for
// them, and 0 for others.
#include "shared/slots_shared.h"

layout(binding = DEPTH_SLOT) uniform sampler2D film_converged;

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** Pixel of the radiance that is the lower left pixel of the film. */
  ivec2 film_origin_px;
};

void main()
{
  ivec2 pixel = ivec2(gl_FragCoord.xy) - film_origin_px;
  float converged = 1.0;
  for (int y = -1; y <= 1; y++) {
    for (int x = -1; x <= 1; x++) {
      ivec2 neighbour = clamp(pixel + ivec2(x, y), ivec2(0), textureSize(film_converged, 0) - 1);
      converged = min(converged, texelFetch(film_converged, neighbour, 0).x);
    }
  }
  gl_FragDepth = converged;
}
