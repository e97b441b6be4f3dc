// SPDX-License-Identifier: MIT
#ifndef EEVEE_WORLD_SHARED_H
#define EEVEE_WORLD_SHARED_H

#include "shared/eevee_bsdf_shared.h"

SHARED_BEGIN

/** Layers of `world_levels`: what a mirror of roughness layer / (count - 1) shows. */
#define WORLD_LEVEL_COUNT 8

/** Content of `world_block`: what is left of the world beside its suns, which are lights like others. */
struct WorldBlock {
  /** rgb: irradiance over π as a polynomial of the normal; see world_irradiance. */
  vec4 harmonics[9];
  /** 1: lights of LIGHT_WORLD give its light, and the harmonics are not read. */
  int is_sampled;
  /** Of a lobe that holds enough of those directions to be drawn by them. Narrower ones are drawn by the levels. */
  float alpha_sampled;
  int _pad0;
  int _pad1;
};
SHARED_ASSERT_SIZE(WorldBlock, 160)

/** Irradiance over π on a surface with the unit vector \a n as its normal (Ramamoorthi and Hanrahan 2001), at least 0. */
SHARED_FUNCTION vec3 world_irradiance(WorldBlock world, vec3 n)
{
  vec4 sum = world.harmonics[0] + world.harmonics[1] * n.y + world.harmonics[2] * n.z + world.harmonics[3] * n.x +
             world.harmonics[4] * (n.x * n.y) + world.harmonics[5] * (n.y * n.z) +
             world.harmonics[6] * (3.0f * n.z * n.z - 1.0f) + world.harmonics[7] * (n.x * n.z) +
             world.harmonics[8] * (n.x * n.x - n.y * n.y);
  return max(vec3(sum), vec3(0.0f));
}

/** Where a direction is in an equirectangular picture, from the left and from the bottom. Any length but 0. */
SHARED_FUNCTION vec2 equirectangular(vec3 v)
{
  float across = sqrt(v.x * v.x + v.z * v.z);
  float azimuth = across > 0.0f ? atan(v.z, v.x) : 0.0f;
  return vec2(0.5f + 0.5f * INV_PI * azimuth, 0.5f + INV_PI * atan(v.y, across));
}

SHARED_END

#endif
