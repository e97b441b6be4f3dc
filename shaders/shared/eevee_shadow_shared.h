// SPDX-License-Identifier: MIT
#ifndef EEVEE_SHADOW_SHARED_H
#define EEVEE_SHADOW_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** Six faces of 90° around a lamp, in the layers `layer` to `layer` + 5 of `shadow_cubes`. */
struct ShadowCubeData {
  /** Distance of the near plane, metres; the far one is infinite: depth = near / distance along the face's axis. */
  float near;
  /** Edge of a texel at distance 1 along the face's axis: 2 / size. */
  float texel_size;
  /** 6 · index. */
  int layer;
  int _pad0;
};
SHARED_ASSERT_SIZE(ShadowCubeData, 16)

/** One view of a spot or a sun, in a layer of `shadow_maps`. */
struct ShadowMapData {
  /** texcomat · clip_from_world: after division by w, xy in [0, 1] inside the map and z the reversed depth. */
  mat4 texco_from_world;
  /** Longer edge of a texel, metres, where w = 1 (a sun's w is 1 everywhere). */
  float texel_size;
  int layer;
  int _pad0;
  int _pad1;
};
SHARED_ASSERT_SIZE(ShadowMapData, 80)

/** One for each light at most. */
#define SHADOW_CUBE_MAX 255
/** As many as the block holds beside the cubes. */
#define SHADOW_MAP_MAX 153

struct ShadowBlock {
  ShadowCubeData cubes[SHADOW_CUBE_MAX];
  ShadowMapData maps[SHADOW_MAP_MAX];
};
SHARED_ASSERT_SIZE(ShadowBlock, SHADOW_CUBE_MAX * 16 + SHADOW_MAP_MAX * 80)
#ifdef __cplusplus
static_assert(SHADOW_MAP_MAX ==
              (UNIFORM_BLOCK_BYTES_MAX - SHADOW_CUBE_MAX * sizeof(ShadowCubeData)) / sizeof(ShadowMapData));
#endif

/** `shadow_render_block`: what the casters are drawn with, one lamp at a time. */
struct ShadowRenderBlock {
  /** One a face; maps use the first. */
  mat4 clip_from_world[6];
};
SHARED_ASSERT_SIZE(ShadowRenderBlock, 384)

/** Faces in OpenGL's order: +X, -X, +Y, -Y, +Z, -Z. \a v not zero; ties go to the earlier axis. */
SHARED_FUNCTION int cube_face(vec3 v)
{
  vec3 a = abs(v);
  if (a.x >= a.y && a.x >= a.z) {
    return v.x >= 0.0f ? 0 : 1;
  }
  if (a.y >= a.z) {
    return v.y >= 0.0f ? 2 : 3;
  }
  return v.z >= 0.0f ? 4 : 5;
}

/**
 * \a v as the face sees it: xy across, z along the face's axis. Equal to (x, y, -z) of cubefacemat[face] · v.
 * The axes are those of OpenGL's cube maps, so that xy / z · 0.5 + 0.5 is the texture coordinate there too.
 */
SHARED_FUNCTION vec3 cube_face_project(int face, vec3 v)
{
  switch (face) {
    case 0: return vec3(-v.z, -v.y, v.x);
    case 1: return vec3(v.z, -v.y, -v.x);
    case 2: return vec3(v.x, v.z, v.y);
    case 3: return vec3(v.x, -v.z, -v.y);
    case 4: return vec3(v.x, -v.y, v.z);
    default: return vec3(-v.x, -v.y, -v.z);
  }
}

/**
 * How far to lift a receiver off its plane, metres, so that no texel of the filter sees the plane itself in front.
 *
 * A texel whose centre lies within r = filter_radius · texel of the lookup, across the light, holds a depth of the
 * receiver's plane up to r · tan(θ) nearer to the light; lifting the receiver by h along its normal brings it h / cos(θ)
 * nearer. So h = r · sin(θ), bounded at every angle. The second term covers rounding, in proportion to the
 * largest coordinate at work.
 *
 * \a texel: edge of a texel at the receiver, metres. \a cos_angle: between the plane's normal and the light.
 */
SHARED_FUNCTION float shadow_lift(float texel, float filter_radius, float cos_angle, float magnitude)
{
  float sin_angle = sqrt(max(1.0f - cos_angle * cos_angle, 0.0f));
  return filter_radius * texel * sin_angle + 2e-6f * magnitude;
}

SHARED_END

#endif
