#version 450 core
// SPDX-License-Identifier: MIT
// The background of pixels without a surface.
#include "shared/eevee_world_shared.h"
#include "shared/slots_shared.h"

#ifdef BACKGROUND_WORLD
/** Equirectangular, rows from the bottom. */
layout(binding = WORLD_PICTURE_SLOT) uniform sampler2D world_picture;
#endif

PUSH_CONSTANT_LAYOUT uniform push_constant_block
{
  /** rgb: radiance, or factor of the picture. */
  vec4 color;
#ifdef BACKGROUND_WORLD
  /** View direction at the lower left corner, and its change per pixel to the right and up. World space, any length. */
  vec4 corner;
  vec4 across;
  vec4 up;
  /** Rotation of the picture, in turns. */
  float turn;
#endif
};

layout(location = 0) out vec4 radiance;

void main()
{
#ifdef BACKGROUND_WORLD
  vec2 texco = equirectangular(corner.xyz + gl_FragCoord.x * across.xyz + gl_FragCoord.y * up.xyz);
  radiance = vec4(color.rgb * textureLod(world_picture, vec2(texco.x + turn, texco.y), 0.0).rgb, 1.0);
#else
  radiance = vec4(color.rgb, 1.0);
#endif
}
