// SPDX-License-Identifier: MIT
#ifndef EEVEE_WORLD_SHARED_H
#define EEVEE_WORLD_SHARED_H

#include "shared/eevee_bsdf_shared.h"

SHARED_BEGIN

/** Layers of `world_levels`: the world, prefiltered for a roughness of layer / (count - 1). */
#define WORLD_LEVEL_COUNT 8

/** Content of `world_block`: the world without its suns, which are lights of `light_block`. */
struct WorldBlock {
  /** rgb: coefficients of irradiance / π as a polynomial of the normal. \see world_irradiance */
  vec4 harmonics[9];
  /** 1: lights of the kind LIGHT_WORLD sample the world, and the harmonics are not read. */
  int is_sampled;
  /** Minimum alpha of a lobe that contains enough sampled directions. Narrower lobes read `world_levels`. */
  float alpha_sampled;
  int _pad0;
  int _pad1;
};
SHARED_ASSERT_SIZE(WorldBlock, 160)

/** Irradiance / π on a surface with the unit normal \a n (Ramamoorthi and Hanrahan 2001). At least 0. */
SHARED_FUNCTION vec3 world_irradiance(WorldBlock world, vec3 n)
{
  vec4 sum = world.harmonics[0] + world.harmonics[1] * n.y + world.harmonics[2] * n.z + world.harmonics[3] * n.x +
             world.harmonics[4] * (n.x * n.y) + world.harmonics[5] * (n.y * n.z) +
             world.harmonics[6] * (3.0f * n.z * n.z - 1.0f) + world.harmonics[7] * (n.x * n.z) +
             world.harmonics[8] * (n.x * n.x - n.y * n.y);
  return max(vec3(sum), vec3(0.0f));
}

/** Coordinates of a direction in an equirectangular picture, from the left and the bottom, in [0, 1]. \a v: any length but 0. */
SHARED_FUNCTION vec2 equirectangular(vec3 v)
{
  float across = sqrt(v.x * v.x + v.z * v.z);
  float azimuth = across > 0.0f ? atan(v.z, v.x) : 0.0f;
  return vec2(0.5f + 0.5f * INV_PI * azimuth, 0.5f + INV_PI * atan(v.y, across));
}

SHARED_END

#endif
