#version 450 core
// SPDX-License-Identifier: MIT
// Adds one sample of the picture to the sum, by blending.
#include "shared/slots_shared.h"

layout(binding = RADIANCE_SLOT) uniform sampler2D radiance_texture;

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** 1 / number of samples. */
  float sample_weight;
};

layout(location = 0) out vec4 sum;

void main()
{
  sum = texelFetch(radiance_texture, ivec2(gl_FragCoord.xy), 0) * sample_weight;
}
