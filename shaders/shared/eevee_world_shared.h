// SPDX-License-Identifier: MIT
#ifndef EEVEE_WORLD_SHARED_H
#define EEVEE_WORLD_SHARED_H

#include "shared/eevee_bsdf_shared.h"

SHARED_BEGIN

/** Layers of `world_levels`: the world, prefiltered for a roughness of layer / (count - 1). */
#define WORLD_LEVEL_COUNT 8

/** Maximum number of suns of a world. */
#define WORLD_SUN_MAX 8
/** Number of points of each sun in each sample of a picture with several samples. */
#define WORLD_SUN_POINTS 16
/** The highlight of a sun is drawn by the directions that have a shadow if the lobe contains this number of them over all samples. */
#define WORLD_SUN_LOBE_DIRECTIONS 24.0f
/** Number of points over all samples in the narrowest lobe that they draw. Narrower lobes are widened to it. */
#define WORLD_SUN_LOBE_POINTS 4.0f

/** Approximate number of directions, over all samples, whose visibility a mirrored direction takes. */
#define WORLD_MIRROR_DIRECTIONS 6.0f

/** Most probes of the visible parts of the world. */
#define WORLD_PROBE_MAX 368

/** A direction within a sun of the world. */
struct WorldSunPoint {
  /** Unit vector, world space. */
  vec3 to_world;
  float _pad0;
  /** Irradiance of a surface perpendicular to it, W/m². The sum over the points of a sun is an estimate of the sun's. */
  vec3 irradiance;
  float _pad1;
};
SHARED_ASSERT_SIZE(WorldSunPoint, 32)

/** Content of `world_block`: the world without its suns, which are lights of `light_block`. */
struct WorldBlock {
  /** rgb: coefficients of irradiance / π as a polynomial of the normal. \see world_irradiance */
  vec4 harmonics[9];
  /** Samples of a picture in which lights of the kind LIGHT_WORLD sample the world and the harmonics are not read; otherwise 0. */
  int sample_count;
  /** Minimum alpha of a lobe that contains enough sampled directions. Narrower lobes read `world_levels`. */
  float alpha_sampled;
  /** Index of the first sun of the world in `light_block`. Its suns follow each other. */
  int first_sun;
  /** Number of suns that have `sun_points`. */
  int sun_count;
  /** WORLD_SUN_POINTS for each sun. They draw highlights that are too narrow for the one direction of a sun in a sample. */
  WorldSunPoint sun_points[WORLD_SUN_MAX * WORLD_SUN_POINTS];
  /** xyz: probes along each axis. 0: nothing blocks the light. */
  vec4 probe_count;
  /** xyz: the place of a position among the probes along each axis is position * scale + offset. */
  vec4 probe_scale;
  vec4 probe_offset;
  /** xyz: irradiance of the whole world on surfaces that face the positive and the negative axes, in any unit. */
  vec4 whole_positive;
  vec4 whole_negative;
  /**
   * Two for each probe, xyz: square roots of the parts of that irradiance that arrive, along the positive and the negative axes. w of
   * the first: the weight of the probe.
   */
  vec4 probes[2 * WORLD_PROBE_MAX];
};
SHARED_ASSERT_SIZE(WorldBlock, 160 + WORLD_SUN_MAX * WORLD_SUN_POINTS * 32 + 80 + 32 * WORLD_PROBE_MAX)

/** Irradiance / π on a surface with the unit normal \a n (Ramamoorthi and Hanrahan 2001). At least 0. */
SHARED_FUNCTION vec3 world_irradiance(WorldBlock world, vec3 n)
{
  vec4 sum = world.harmonics[0] + world.harmonics[1] * n.y + world.harmonics[2] * n.z + world.harmonics[3] * n.x +
             world.harmonics[4] * (n.x * n.y) + world.harmonics[5] * (n.y * n.z) +
             world.harmonics[6] * (3.0f * n.z * n.z - 1.0f) + world.harmonics[7] * (n.x * n.z) +
             world.harmonics[8] * (n.x * n.x - n.y * n.y);
  return max(vec3(sum), vec3(0.0f));
}

/**
 * Square of the chord up to which a sampled direction stands for the visibility of mirrored directions. \a solid_angle: that the
 * direction represents in the whole picture, sr.
 */
SHARED_FUNCTION float world_mirror_reach_sq(float solid_angle)
{
  return min(WORLD_MIRROR_DIRECTIONS * INV_PI * solid_angle, 1.0f);
}

/**
 * Weight of a probe for a surface. \a height: of the probe above the plane of the surface, in cells. A probe below the plane is behind a
 * wall, or sees the body block light that the surface has not lost: its light matters only where all probes are below.
 */
SHARED_FUNCTION float world_probe_weight(float height)
{
  return min(max(2.0f * height, 0.001f), 1.0f);
}

/**
 * Weight of a sampled direction for a mirrored one. \a distance_sq: square of their chord / world_mirror_reach_sq. The small outer part
 * reaches mirrored directions to which no sampled direction is near.
 */
SHARED_FUNCTION float world_mirror_weight(float distance_sq)
{
  float inner = max(1.0f - distance_sq, 0.0f);
  float outer = max(1.0f - 0.25f * distance_sq, 0.0f);
  return inner * inner + 0.05f * outer * outer;
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
