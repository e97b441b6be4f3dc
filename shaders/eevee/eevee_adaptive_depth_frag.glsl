#version 450 core
// SPDX-License-Identifier: MIT
// Depths of converged pixels: nearer than all objects, so that the depth test skips them, or inverted: behind all objects.
#include "shared/slots_shared.h"

layout(binding = DEPTH_SLOT) uniform sampler2D drawn_converged;

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** 0: depth 1 (nearest) for converged pixels, 0 for others. 1: depth 0 for converged pixels, 1 for others. */
  float is_inverted;
};

void main()
{
  gl_FragDepth = abs(is_inverted - texelFetch(drawn_converged, ivec2(gl_FragCoord.xy), 0).x);
}
