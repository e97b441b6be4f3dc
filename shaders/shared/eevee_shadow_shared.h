// SPDX-License-Identifier: MIT
#ifndef EEVEE_SHADOW_SHARED_H
#define EEVEE_SHADOW_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** Texels by which a cube face extends beyond its 90° on each side, so that no filter kernel crosses its edge. */
#define CUBE_BORDER_TEXELS 3

/** Values of `filter_kind`. */
#define SHADOW_FILTER_HARD 0
#define SHADOW_FILTER_PCF 1

/** Faces around a lamp, in layers of `shadow_cubes`, in the lower left `size_px`² of each. */
struct ShadowCubeData {
  /** Distance of the near plane, metres. The far plane is at infinity: depth = near / distance along the face's axis. */
  float near;
  /** Receivers beyond this distance along the face's axis are lit, metres. */
  float far;
  /** Longer edge of a texel at a distance of 1 m along the face's axis, metres. */
  float texel_size;
  /** Factor of the derived normal offset. 0: no offset. */
  float bias;
  /** \see cube_layers */
  int layers;
  /** Bit i: face i was drawn. The other faces contain no caster. The bits from 6 on are SHADOW_FILTER_… */
  int faces_and_filter;
  /** The part of each face that its layer holds: left, bottom, right and top edge, as unpackUnorm4x8 gives them. */
  uint crop;
  int size_px;
};
SHARED_ASSERT_SIZE(ShadowCubeData, 32)

/** \see ShadowCubeData::faces_and_filter */
#define SHADOW_CUBE_FACE_BITS 6

/** Layers of the faces: \a first, plus \a steps, three bits for each face. Faces that were not drawn need no layer. */
SHARED_FUNCTION int cube_layers(int first, int steps)
{
  return first << 18 | steps;
}

/** \a layers: \see cube_layers */
SHARED_FUNCTION int cube_face_layer(int layers, int face)
{
  return (layers >> 18) + (layers >> 3 * face & 7);
}

/** One map of a spot or a sun, in a layer of `shadow_maps`. The map's axis is LightData::forward_ws of the lamp. */
struct ShadowMapData {
  /** texcomat · clip_from_world. After the division by w, xy are in [0, 1] inside the map and z is the reversed depth. */
  mat4 texco_from_world;
  /** Longer edge of a texel at w = 1, metres. A sun's w is 1 everywhere. */
  float texel_size;
  /** Error of stored depths at w = 1, metres. It grows with w². \see DEPTH_ROUNDING */
  float rounding;
  /** Receivers beyond this w are lit. */
  float far;
  /** Factor of the derived normal offset. 0: no offset. */
  float bias;
  int layer;
  /** Number of maps of the same lamp from this one on, from fine to coarse: the cascades of a sun. 1 for a spot. */
  int cascade_count;
  /** SHADOW_FILTER_… */
  int filter_kind;
  int size_px;
};
SHARED_ASSERT_SIZE(ShadowMapData, 96)

/** At most one for each light. */
#define SHADOW_CUBE_MAX 255
/** The number of maps that fit into the block beside the cubes. */
#define SHADOW_MAP_MAX 85

struct ShadowBlock {
  ShadowCubeData cubes[SHADOW_CUBE_MAX];
  ShadowMapData maps[SHADOW_MAP_MAX];
};
SHARED_ASSERT_SIZE(ShadowBlock, SHADOW_CUBE_MAX * 32 + SHADOW_MAP_MAX * 96)
SHARED_ASSERT(UNIFORM_BLOCK_BYTES_MAX - sizeof(ShadowBlock) < sizeof(ShadowMapData))

/** Content of `shadow_render_block`: the matrices that the casters of one lamp are drawn with. */
struct ShadowRenderBlock {
  /** One for each face of a cube or each cascade of a sun. A spot uses the first. */
  mat4 clip_from_world[6];
  /** Edge of a layer. */
  float size_px;
  float _pad0;
  float _pad1;
  float _pad2;
};
SHARED_ASSERT_SIZE(ShadowRenderBlock, 400)

/** Fraction of a face's width that its 90° cover: 1 minus the border. \a size_px: edge of the face, at least 1. */
SHARED_FUNCTION float cube_uv_scale(float size_px)
{
  return 1.0f - 2.0f * min(float(CUBE_BORDER_TEXELS) / size_px, 0.125f);
}

/** Face that \a v points to, in OpenGL's order: +X, -X, +Y, -Y, +Z, -Z. \a v is not zero. Ties go to the earlier axis. */
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
 * \a v in the space of a face: xy across, z along the face's axis. Equal to (x, y, -z) of cubefacemat[face] · v.
 * The axes are those of OpenGL's cube maps, so that xy / z · 0.5 + 0.5 is the texture coordinate of a cube map.
 */
SHARED_FUNCTION vec3 cube_face_project(int face, vec3 v)
{
  // Products with +-1 instead of a case for each face: compilers for CPUs evaluate all cases.
  int axis = face >> 1;
  float side = 1.0f - 2.0f * float(face & 1);
  return axis == 0 ? vec3(-side * v.z, -v.y, side * v.x) :
         axis == 1 ? vec3(v.x, side * v.z, side * v.y) :
                     vec3(side * v.x, -v.y, side * v.z);
}

/**
 * Bound of the error of a rasterised depth, relative to the largest depth of the triangle: one ulp of a float. Drivers may
 * differ; the rendered groups of `gnomon stability` check it on a driver.
 */
SHARED_CONSTANT float DEPTH_ROUNDING = 1.2e-7f;

/** Additional normal offset, in texels: at an edge between facets, the plane of one facet ends within a texel. */
SHARED_CONSTANT float NORMAL_OFFSET_TEXELS = 0.1f;

/**
 * Normal offset of a receiver, metres, so that rounding does not make its plane shadow itself. It does not depend on the
 * slope of the plane, because each texel is compared with the plane's depth at that texel.
 *
 * \a texel: edge of a texel at the receiver, metres. \a reach: reach of the filter kernel to each side, texels; 1 for the
 * four texels around a lookup. \a rounding: error of depths at the receiver, metres. \a magnitude: the largest absolute
 * world coordinate in the computation, metres.
 */
SHARED_FUNCTION float shadow_normal_offset(float texel, float reach, float rounding, float magnitude)
{
  return NORMAL_OFFSET_TEXELS * reach * texel + rounding + 1e-6f * magnitude;
}

/**
 * Depth of a plane at four texels, in the order of textureGather: (0, 1), (1, 1), (1, 0), (0, 0).
 *
 * \a depth: depth at the lookup. \a slope: change of depth for each texel, across and up. The depth of a plane is affine over
 * a map, in perspective too. \a offset: from the lookup to the centre of the first texel, (0, 0), in texels.
 */
SHARED_FUNCTION vec4 plane_depths(float depth, vec2 slope, vec2 offset)
{
  vec2 high = offset + vec2(1.0f);
  return vec4(depth) + slope.x * vec4(offset.x, high.x, high.x, offset.x) +
         slope.y * vec4(high.y, high.y, offset.y, offset.y);
}

/**
 * 1 for each of four texels, in the order of textureGather, that does not shadow the receiver, else 0. A texel does not shadow
 * the receiver if its stored depth is not nearer than the receiver's (reversed depth: not greater).
 */
SHARED_FUNCTION vec4 texels_lit(vec4 stored, vec4 receiver)
{
  // A receiver beyond the far plane gets the cleared depth 0, so that empty texels do not shadow it.
  return step(stored, max(receiver, vec4(0.0f)));
}

/** Weighted sum of four texels in the order of textureGather. \a columns, \a rows: x weights the first, y the second. */
SHARED_FUNCTION float weighted_texels(vec4 lit, vec2 columns, vec2 rows)
{
  return rows.x * (columns.x * lit.w + columns.y * lit.z) + rows.y * (columns.x * lit.x + columns.y * lit.y);
}

/** Quotient for slopes. 0 for a plane seen edge-on, whose slope is undefined. */
SHARED_FUNCTION float slope_quotient(float numerator, float denominator)
{
  return abs(denominator) > 1e-30f ? numerator / denominator : 0.0f;
}

SHARED_END

#endif
