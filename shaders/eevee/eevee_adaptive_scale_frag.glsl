#version 450 core
// SPDX-License-Identifier: MIT
// Multiplies converged pixels of the film by blending, so that their mean stays while others get further samples.
#include "shared/slots_shared.h"

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  vec4 factor;
};

layout(location = 0) out vec4 color;

void main()
{
  color = factor;
}
