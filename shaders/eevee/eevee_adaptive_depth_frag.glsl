#version 450 core
// SPDX-License-Identifier: MIT
// Writes the depths with which the depth test skips converged pixels, or, inverted, those that end it.
#include "shared/slots_shared.h"

layout(binding = DEPTH_SLOT) uniform sampler2D drawn_converged;

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** 1: depth 0 for converged pixels and 1 for the others. 0: the other way round. */
  float is_inverted;
};

void main()
{
  gl_FragDepth = abs(is_inverted - texelFetch(drawn_converged, ivec2(gl_FragCoord.xy), 0).x);
}
