// SPDX-License-Identifier: MIT
#ifndef EEVEE_LIGHT_SHARED_H
#define EEVEE_LIGHT_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** LightData::kind. */
#define LIGHT_POINT 0
#define LIGHT_SUN 1
#define LIGHT_SPOT 2
#define LIGHT_HEMI 3
/** A sampled direction of the world without its suns. */
#define LIGHT_WORLD 4
#define LIGHT_RECTANGLE 5
#define LIGHT_ELLIPSE 6
/** A sampled point of an emissive surface, which emits to both sides. */
#define LIGHT_SURFACE 7
/**
 * Specular lobes for such points are widened until they contain this number of the points of all samples. The density of points around
 * the lit point is assumed to be equal in all directions.
 */
#define SURFACE_LOBE_POINTS 12.0f
/**
 * With several samples, a specular lobe which contains fewer than this number of a lamp's points of all samples reflects the whole
 * lamp, in closed form, times the visibility of the point. Other lobes reflect the points.
 */
#define HIGHLIGHT_LOBE_POINTS 64.0f

/** LightData::shadow_kind. */
#define SHADOW_NONE 0
#define SHADOW_CUBE 1
#define SHADOW_MAP 2
#define SHADOW_ESM 3

/** A lamp: an entry of `light_block`, or four texels of `light_texture`. */
struct LightData {
  /** Position, world space, metres. Unused by sun and hemi. */
  vec3 position_ws;
  /** LIGHT_… */
  int kind;
  /**
   * Linear RGB. Sun, hemi, world: irradiance, W/m². Point, spot: radiant intensity, W/sr. Rectangle, ellipse, surface:
   * radiant intensity along forward_ws, W/sr; other directions follow the cosine law.
   */
  vec3 color;
  /**
   * Point, spot: square of the radius, m². 0: a point. Sun: minimum alpha² of the specular lobe for its highlight (used
   * with a world; 0: none). World: solid angle that the direction represents, sr. Surface: of the disk that the point
   * stands for, m².
   */
  float radius_sq;
  /** Unit vector along the axis of the lamp, in the direction of emission. */
  vec3 forward_ws;
  /** 1 / range², 1/m². 0: no limit. */
  float range_inv_sq;
  /** Spot: 1 - cos of half the opening angle. It is stored instead of the cosine, which would round to 1 for narrow cones. */
  float spot_drop_outer;
  /** Spot: 1 / (spot_drop_outer · blend), finite. */
  float spot_inv_width;
  /** SHADOW_… */
  int shadow_kind;
  /** Index of the first entry: in ShadowBlock::cubes, ShadowBlock::maps or EsmBlock::lamps, by shadow_kind. -1: none. */
  int shadow_index;
};
SHARED_ASSERT_SIZE(LightData, 64)

/** The number of entries that fit into the smallest guaranteed uniform block, beside the count. */
#define LIGHT_MAX 255

struct LightBlock {
  /** Without surface_point_count. */
  int light_count;
  /** Number of lights whose shadow may be a cube: points, areas and wide spots. They are the first in `lights`. */
  int cube_light_count;
  /** Number of points of emissive surfaces without shadows. They follow the other lights, and only one sample has them. */
  int surface_point_count;
  int _pad0;
  LightData lights[LIGHT_MAX];
};
SHARED_ASSERT_SIZE(LightBlock, 16 + LIGHT_MAX * 64)
SHARED_ASSERT(LIGHT_MAX == (UNIFORM_BLOCK_BYTES_MAX - 16) / sizeof(LightData))

/** Extent and axes of a lamp: an entry of `light_shape_block`, which exists only with USE_LAMP_SHAPE. */
struct LightShape {
  /**
   * Rectangle, ellipse: vector from the centre to the middle of an edge or to the rim, metres. Spot: a unit vector
   * perpendicular to the spot's axis, divided by spot_scale, so that the cone is circular in these coordinates.
   */
  vec3 axis_x_ws;
  /**
   * Above 0: the lamp is shaded as a whole. Point, spot: radius, metres. Sun: tangent of half its angular diameter.
   * Rectangle, ellipse: 1. 0: the lamp is shaded as a point at LightData::position_ws, or by the direction forward_ws.
   */
  float extent;
  /** The same as axis_x_ws, for the other axis. */
  vec3 axis_y_ws;
  /** With highlight_extent: HIGHLIGHT_LOBE_POINTS divided by the number of samples. */
  float highlight_points_share;
  /** With highlight_extent: centre of the lamp, world space, metres; of a sun, the unit vector to its centre. */
  vec3 center_ws;
  /**
   * Above 0: the lamp is shaded as a point, and its highlights on smooth surfaces as a whole. The value is that of `extent` for
   * a lamp that is shaded as a whole.
   */
  float highlight_extent;
};
SHARED_ASSERT_SIZE(LightShape, 48)

/** Content of `light_shape_block`: one entry for each light of `light_block`, in the same order. */
struct LightShapeBlock {
  LightShape shapes[LIGHT_MAX];
};
SHARED_ASSERT_SIZE(LightShapeBlock, LIGHT_MAX * 48)

/** Smaller blends are treated as hard edges, so that the inverse stays finite. */
SHARED_CONSTANT float SPOT_BLEND_MIN = 1e-6f;

/** Value for LightData::spot_inv_width. \a drop_outer in [0, 1], \a blend in [0, 1]. */
SHARED_FUNCTION float spot_inv_width(float drop_outer, float blend)
{
  return 1.0f / max(drop_outer * max(blend, SPOT_BLEND_MIN), 1e-30f);
}

/** 1 - cos of the angle between two unit vectors, as |a - b|² / 2, which does not cancel for small angles. */
SHARED_FUNCTION float one_minus_cos(vec3 a, vec3 b)
{
  vec3 apart = a - b;
  return 0.5f * dot(apart, apart);
}

/**
 * The value `drop` of spot_mask for a spot with an elliptical cone: 1 - cos of the angle to the axis, in coordinates in
 * which the cone is circular. \a from_light: unit vector. \a axis_x, \a axis_y: from LightShape.
 */
SHARED_FUNCTION float elliptic_drop(vec3 from_light, vec3 forward, vec3 axis_x, vec3 axis_y)
{
  vec3 round = vec3(dot(from_light, axis_x), dot(from_light, axis_y), dot(from_light, forward));
  return one_minus_cos(round / max(sqrt(dot(round, round)), 1e-18f), vec3(0.0f, 0.0f, 1.0f));
}

/**
 * Transmission of a spot's cone, in [0, 1]: a smoothstep over the soft edge. \a drop: 1 - cos of the angle between the
 * lamp's forward vector and the direction to the receiver, in [0, 2]. The result is monotone, finite, and 0 on and
 * outside the cone.
 */
SHARED_FUNCTION float spot_mask(float drop, float drop_outer, float inv_width)
{
  float t = clamp((drop_outer - drop) * inv_width, 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

/**
 * Fall-off of a point or spot lamp, 1/m²: 1 / (d² + r²) for a disk of radius r turned to the receiver, times the window
 * of KHR_lights_punctual for its range. Finite at d = 0.
 */
SHARED_FUNCTION float distance_falloff(float distance_sq, float radius_sq, float range_inv_sq)
{
  float ratio = distance_sq * range_inv_sq;
  float window = max(1.0f - ratio * ratio, 0.0f);
  return window / max(distance_sq + radius_sq, 1e-12f);
}

/** Irradiance from a uniform hemispherical sky, relative to a surface that faces it: (1 + cos) / 2. */
SHARED_FUNCTION float hemi_irradiance(float cos_angle)
{
  return 0.5f + 0.5f * cos_angle;
}

SHARED_END

#endif
