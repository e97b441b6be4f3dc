// SPDX-License-Identifier: MIT
#ifndef EEVEE_SHADOW_SHARED_H
#define EEVEE_SHADOW_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** Texels that a cube's face shows beyond its 90° on each side, so that no filter's kernel reaches past its edge. */
#define CUBE_BORDER_TEXELS 3

/** `filter` of a shadow. */
#define SHADOW_FILTER_HARD 0
#define SHADOW_FILTER_PCF 1

/** Six faces around a lamp, in the layers `layer` to `layer` + 5 of `shadow_cubes`, each in its lower left `size_px`². */
struct ShadowCubeData {
  /** Distance of the near plane, metres; the far one is infinite: depth = near / distance along the face's axis. */
  float near;
  /** Beyond this distance along the axis nothing is in shadow, metres. */
  float far;
  /** Edge of a texel at distance 1 along the face's axis. */
  float texel_size;
  /** Scales the derived lift: 1 is derived, 0 none. */
  float bias;
  /** The first of six. */
  int layer;
  /** Bit i: face i was drawn; into the others nothing casts. */
  int face_mask;
  /** SHADOW_FILTER_… */
  int filter_kind;
  int size_px;
};
SHARED_ASSERT_SIZE(ShadowCubeData, 32)

/** One view of a spot or a sun, in a layer of `shadow_maps`. The map's axis is the lamp's LightData::forward_ws. */
struct ShadowMapData {
  /** texcomat · clip_from_world: after division by w, xy in [0, 1] inside the map and z the reversed depth. */
  mat4 texco_from_world;
  /** Longer edge of a texel, metres, where w = 1 (a sun's w is 1 everywhere). */
  float texel_size;
  /** Error of stored depths where w = 1, metres; it grows with w². \see DEPTH_ROUNDING */
  float rounding;
  /** Beyond this w nothing is in shadow. */
  float far;
  /** As of cubes. */
  float bias;
  int layer;
  /** Maps of the same lamp from this one on, from fine to coarse: the cascades of a sun; 1 for a spot. */
  int cascade_count;
  /** SHADOW_FILTER_… */
  int filter_kind;
  int size_px;
};
SHARED_ASSERT_SIZE(ShadowMapData, 96)

/** One for each light at most. */
#define SHADOW_CUBE_MAX 255
/** As many as the block holds beside the cubes. */
#define SHADOW_MAP_MAX 85

struct ShadowBlock {
  ShadowCubeData cubes[SHADOW_CUBE_MAX];
  ShadowMapData maps[SHADOW_MAP_MAX];
};
SHARED_ASSERT_SIZE(ShadowBlock, SHADOW_CUBE_MAX * 32 + SHADOW_MAP_MAX * 96)
SHARED_ASSERT(UNIFORM_BLOCK_BYTES_MAX - sizeof(ShadowBlock) < sizeof(ShadowMapData))

/** `shadow_render_block`: what the casters are drawn with, one lamp at a time. */
struct ShadowRenderBlock {
  /** One a face of a cube, or a cascade of a sun; spots use the first. */
  mat4 clip_from_world[6];
};
SHARED_ASSERT_SIZE(ShadowRenderBlock, 384)

/** Share of a face's width that its 90° take: 1 less the border. \a size_px: of the face, at least 1. */
SHARED_FUNCTION float cube_uv_scale(float size_px)
{
  return 1.0f - 2.0f * min(float(CUBE_BORDER_TEXELS) / size_px, 0.125f);
}

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

/** Of a depth where rasterisation has rounded it, relative to the largest depth of the triangle. */
SHARED_CONSTANT float DEPTH_ROUNDING = 1.2e-7f;

/** Share of a texel by which a receiver is lifted besides: where facets meet, the plane of one ends within a texel. */
SHARED_CONSTANT float LIFT_TEXELS = 0.1f;

/**
 * How far to lift a receiver off its plane, metres, so that rounding does not put the plane in front of itself. The
 * slope of the plane is not its business: each texel is compared with the plane's own depth there.
 *
 * \a texel: edge of a texel at the receiver, metres. \a reach: of the filter's kernel to each side, texels, 1 for the
 * four around a lookup. \a rounding: error of depths there, metres. \a magnitude: the largest world coordinate at work.
 */
SHARED_FUNCTION float shadow_lift(float texel, float reach, float rounding, float magnitude)
{
  return LIFT_TEXELS * reach * texel + rounding + 1e-6f * magnitude;
}

/**
 * Depth of a plane at four texels, in the order of textureGather: (0, 1), (1, 1), (1, 0), (0, 0).
 *
 * \a depth: at the lookup. \a slope: change of depth a texel, across and up; depth is affine over a map for
 * planes, in perspective too. \a offset: from the lookup to the centre of the first texel, (0, 0), texels.
 */
SHARED_FUNCTION vec4 plane_depths(float depth, vec2 slope, vec2 offset)
{
  vec2 high = offset + vec2(1.0f);
  return vec4(depth) + slope.x * vec4(offset.x, high.x, high.x, offset.x) +
         slope.y * vec4(high.y, high.y, offset.y, offset.y);
}

/**
 * Which of four texels, in the order of textureGather, let light through to a receiver, 1 or 0: those whose stored
 * depth is not nearer than the receiver's (reversed: not greater).
 */
SHARED_FUNCTION vec4 texels_lit(vec4 stored, vec4 receiver)
{
  // Behind the far end a receiver is as far as what was cleared: nothing cast there.
  return step(stored, max(receiver, vec4(0.0f)));
}

/** Sum of four texels in the order of textureGather, columns and rows weighted: x the first, y the second. */
SHARED_FUNCTION float weighted_texels(vec4 lit, vec2 columns, vec2 rows)
{
  return rows.x * (columns.x * lit.w + columns.y * lit.z) + rows.y * (columns.x * lit.x + columns.y * lit.y);
}

/** A disk of \a count taps that covers equal areas (Vogel 1979), of radius 1. \a i from 0 to count - 1. */
SHARED_FUNCTION vec2 vogel_disk(int i, int count)
{
  float radius = sqrt((float(i) + 0.5f) / float(count));
  float angle = 2.39996323f * float(i);
  return vec2(radius * cos(angle), radius * sin(angle));
}

/** A quotient for slopes: 0 where the plane is seen edge-on and has none. */
SHARED_FUNCTION float slope_quotient(float numerator, float denominator)
{
  return abs(denominator) > 1e-30f ? numerator / denominator : 0.0f;
}

SHARED_END

#endif
