// SPDX-License-Identifier: MIT
// Light of a lamp with an extent, integrated over the lamp: form factors of disks and polygons that are clipped at the horizon, and
// linearly transformed cosines (Heitz, Dupuy, Hill and Neubelt 2016).
#ifndef EEVEE_SHAPE_SHARED_H
#define EEVEE_SHAPE_SHARED_H

#include "shared/eevee_bsdf_shared.h"

SHARED_BEGIN

/** Texels along each axis of the two halves of `ltc_table`: matrices on the left, albedos on the right. */
#define LTC_TABLE_SIZE 32

/** Corners of the polygon that approximates an ellipse, and of a rectangle. */
#define ELLIPSE_CORNERS 16
#define RECTANGLE_CORNERS 4

/** Radius divided by distance, of a lamp of the radius \a extent; of a sun, with a distance of 1, the tangent itself. */
SHARED_FUNCTION float round_lamp_tangent(float extent, float distance_sq)
{
  // The limits prevent an overflow. At a distance of 1e-9 radii, the lamp already fills the half space.
  return min(extent * (1.0f / sqrt(max(distance_sq, 1e-30f))), 1e9f);
}

/** Solid angle of a round lamp, sr. */
SHARED_FUNCTION float round_lamp_solid_angle(float tangent)
{
  return 2.0f * PI * (1.0f - 1.0f / sqrt(1.0f + tangent * tangent));
}

/** Area of a rectangle, or of an ellipse, with these half axes. */
SHARED_FUNCTION float flat_lamp_area(vec3 axis_x, vec3 axis_y, bool is_rectangle)
{
  vec3 across = cross(axis_x, axis_y);
  return (is_rectangle ? 4.0f : PI) * sqrt(dot(across, across));
}

/** The same as seen along the unit vector \a direction. */
SHARED_FUNCTION float flat_lamp_area_along(vec3 axis_x, vec3 axis_y, bool is_rectangle, vec3 direction)
{
  return (is_rectangle ? 4.0f : PI) * abs(dot(cross(axis_x, axis_y), direction));
}

/** About the solid angle of a flat lamp, sr. \a area: its area times the cosine of the angle at which it is seen. */
SHARED_FUNCTION float flat_lamp_solid_angle(float area, float distance_sq)
{
  return area / (max(distance_sq, 1e-30f) + area * (0.5f * INV_PI));
}

/** Half the size of a lamp, divided by its distance and by the alpha of a lobe, below which the lobe has one value for all of it. */
SHARED_CONSTANT float SMALL_LAMP = 0.1f;

/** Whether a flat lamp is small relative to a lobe. \see SMALL_LAMP */
SHARED_FUNCTION bool is_small_lamp(vec3 center, vec3 axis_x, vec3 axis_y, float alpha)
{
  float size = SMALL_LAMP * alpha;
  return max(dot(axis_x, axis_x), dot(axis_y, axis_y)) < size * size * dot(center, center);
}

/**
 * Alpha of a lobe that contains HIGHLIGHT_LOBE_POINTS points of a lamp. Its solid angle is about 4 π alpha². \a points_share:
 * LightShape::highlight_points_share. \a solid_angle: of the lamp.
 */
SHARED_FUNCTION float highlight_alpha(float points_share, float solid_angle)
{
  return sqrt(points_share * solid_angle * (0.25f * INV_PI));
}

/** Angle of a direction whose cosine is \a x, radians. \a x in [-1, 1]. */
SHARED_FUNCTION float angle_of_cosine(float x)
{
  return atan(sqrt(max((1.0f - x) * (1.0f + x), 0.0f)), x);
}

/**
 * Form factor of a round lamp that faces the receiver, divided by that for a surface that faces the lamp: the irradiance as a
 * cosine. It equals \a cosine while the whole lamp is above the horizon.
 *
 * \a sine_sq: square of the sine of half the angle that the lamp spans, in (0, 1]. \a cosine: of the angle between the normal and
 * the direction to the lamp's centre. The result is in [0, 1]. The closed form is that of a sphere cut by a plane (Quilez 2014).
 * For a lamp of a few degrees it cancels, so a flat disk with a straight horizon replaces it.
 */
SHARED_FUNCTION float disk_cosine(float sine_sq, float cosine)
{
  float sine = sqrt(sine_sq);
  if (cosine >= sine) {
    return cosine;
  }
  if (cosine <= -sine) {
    return 0.0f;
  }
  if (sine_sq < 1e-3f) {
    float t = cosine / sine;
    float chord = sqrt(max((1.0f - t) * (1.0f + t), 0.0f));
    float above = 0.5f + INV_PI * (atan(t, chord) + t * chord);
    return max(sine * (t * above + (2.0f / 3.0f) * INV_PI * chord * chord * chord), 0.0f);
  }
  float cot_sq = (1.0f - sine_sq) / sine_sq;
  float k_sq = max(1.0f - cosine * cosine / sine_sq, 0.0f);
  float cut = clamp(-cosine * sqrt(cot_sq / max((1.0f - cosine) * (1.0f + cosine), 1e-12f)), -1.0f, 1.0f);
  float sum = cosine * angle_of_cosine(cut) - sqrt(k_sq * cot_sq) + atan(sqrt(k_sq), sqrt(cot_sq)) / sine_sq;
  return clamp(INV_PI * sum, 0.0f, 1.0f);
}

/** Contribution of one edge to the flux from a polygon (Lambert 1760). Vectors of any length. */
SHARED_FUNCTION vec3 edge_flux(vec3 a, vec3 b)
{
  a = a / max(sqrt(dot(a, a)), 1e-18f);
  b = b / max(sqrt(dot(b, b)), 1e-18f);
  vec3 across = cross(a, b);
  float sine = sqrt(dot(across, across));
  // The quotient approaches 1 for a short edge; its numerator is then 0 as well.
  return across * (0.5f * INV_PI * (atan(sine, dot(a, b)) / max(sine, 1e-18f)));
}

/** Intersection of an edge with a plane through the receiver. The heights have different signs, or one is 0. */
SHARED_FUNCTION vec3 edge_at_plane(vec3 a, vec3 b, float height_a, float height_b)
{
  float rise = height_b - height_a;
  return a - (b - a) * (height_a / (abs(rise) > 1e-30f ? rise : 1e-30f));
}

/** A polygon, clipped at the plane z = 0. */
struct CutPolygon {
  /** Sum of the edges' flux. */
  vec3 flux;
  /** Points where the edges rise and sink through the plane; 0 if there are none. */
  vec3 risen;
  vec3 sunk;
};

SHARED_FUNCTION CutPolygon with_edge(CutPolygon polygon, vec3 a, vec3 b)
{
  if (a.z > 0.0f || b.z > 0.0f) {
    vec3 from = a;
    vec3 to = b;
    if (!(a.z > 0.0f)) {
      from = edge_at_plane(a, b, a.z, b.z);
      from.z = 0.0f;
      polygon.risen = from;
    }
    if (!(b.z > 0.0f)) {
      to = edge_at_plane(a, b, a.z, b.z);
      to.z = 0.0f;
      polygon.sunk = to;
    }
    polygon.flux += edge_flux(from, to);
  }
  return polygon;
}

/**
 * Flux from a flat lamp, clipped at the horizon of a surface with the normal +z. Its direction is the mean direction of the light,
 * and its z is the lamp's form factor, irradiance / (π · radiance), in [0, 1]. It is the same from both sides of the lamp.
 *
 * \a center: centre of the lamp relative to the receiver. \a axis_x, \a axis_y: half axes, in any directions. \a corner_count:
 * RECTANGLE_CORNERS for the parallelogram center ± axis_x ± axis_y; ELLIPSE_CORNERS for a polygon with the area of the ellipse of these
 * axes. \a up: normal of a second clipping plane through the receiver; vec3(0, 0, 1) for none. Finite for all finite arguments whose
 * squares are finite; 0 for a lamp without area or seen edge-on.
 */
SHARED_FUNCTION vec3 flat_flux(vec3 center, vec3 axis_x, vec3 axis_y, int corner_count, vec3 up)
{
  bool is_rectangle = corner_count == RECTANGLE_CORNERS;
  float distance_sq = dot(center, center);
  if (max(dot(axis_x, axis_x), dot(axis_y, axis_y)) < 1e-5f * distance_sq) {
    // Sums over the edges of a small polygon cancel, so it is treated as a point.
    vec3 to_lamp = center / sqrt(distance_sq);
    float facing = abs(dot(cross(axis_x / distance_sq, axis_y), to_lamp));
    bool is_up = to_lamp.z > 0.0f && dot(to_lamp, up) > 0.0f;
    return to_lamp * (is_up ? (is_rectangle ? 4.0f * INV_PI : 1.0f) * facing : 0.0f);
  }
  // First corner and rotation to the next corner: of a regular polygon of area π, or of the rectangle with corners (±1, ±1).
  // Constants, because Vulkan lets the sine and cosine of a driver be off by 5e-4, and small lamps are small differences.
  const float step_angle = 2.0f * PI / float(ELLIPSE_CORNERS);
  vec2 turn = is_rectangle ? vec2(0.0f, 1.0f) : vec2(cos(step_angle), sin(step_angle));
  vec2 at = is_rectangle ? vec2(1.0f, 1.0f) : vec2(sqrt(step_angle / turn.y), 0.0f);
  CutPolygon polygon;
  polygon.flux = vec3(0.0f);
  polygon.risen = vec3(0.0f);
  polygon.sunk = vec3(0.0f);
  vec3 risen = vec3(0.0f);
  vec3 sunk = vec3(0.0f);
  vec3 a = center + at.x * axis_x + at.y * axis_y;
  float height_a = dot(a, up);
  for (int i = 0; i < corner_count; i++) {
    at = vec2(at.x * turn.x - at.y * turn.y, at.x * turn.y + at.y * turn.x);
    vec3 b = center + at.x * axis_x + at.y * axis_y;
    float height_b = dot(b, up);
    if (height_a > 0.0f || height_b > 0.0f) {
      vec3 from = a;
      vec3 to = b;
      if (!(height_a > 0.0f)) {
        from = edge_at_plane(a, b, height_a, height_b);
        risen = from;
      }
      if (!(height_b > 0.0f)) {
        to = edge_at_plane(a, b, height_a, height_b);
        sunk = to;
      }
      polygon = with_edge(polygon, from, to);
    }
    a = b;
    height_a = height_b;
  }
  // A convex polygon crosses a plane twice or not at all. An edge in the plane closes it; without a crossing its ends are 0.
  polygon = with_edge(polygon, sunk, risen);
  vec3 flux = polygon.flux + edge_flux(polygon.sunk, polygon.risen);
  // The sign depends on the order of the corners.
  flux = flux.z < 0.0f ? vec3(0.0f) - flux : flux;
  return vec3(flux.x, flux.y, min(flux.z, 1.0f));
}

/** Texture coordinates in the left half of `ltc_table`. \a cos_v: cosine of the view direction, in (0, 1]. \a alpha: in (0, 1]. */
SHARED_FUNCTION vec2 ltc_texco(float alpha, float cos_v)
{
  vec2 at = vec2(sqrt(alpha), sqrt(max(1.0f - cos_v, 0.0f)));
  vec2 texel = vec2(0.5f) + at * float(LTC_TABLE_SIZE - 1);
  return texel / vec2(float(2 * LTC_TABLE_SIZE), float(LTC_TABLE_SIZE));
}

/**
 * Transforms \a v to the space in which the lobe is a cosine around +z. \a matrix: from the table. \a v: z along the normal, x
 * towards the viewer.
 */
SHARED_FUNCTION vec3 ltc_transformed(vec4 matrix, vec3 v)
{
  return vec3(matrix.x * v.x + matrix.y * v.z, v.y, matrix.z * v.x + matrix.w * v.z);
}

/** The inverse of ltc_transformed, up to a factor. */
SHARED_FUNCTION vec3 ltc_restored(vec4 matrix, vec3 v)
{
  float determinant = matrix.x * matrix.w - matrix.y * matrix.z;
  return vec3(matrix.w * v.x - matrix.y * v.z, determinant * v.y, matrix.x * v.z - matrix.z * v.x);
}

/** The surface's normal in the space of ltc_transformed, up to a factor. The lobe ends at this horizon, the cosine does not. */
SHARED_FUNCTION vec3 ltc_up(vec4 matrix)
{
  return vec3(-matrix.z, 0.0f, matrix.x);
}

/** Density of the transformed cosine in the direction of the unit vector \a v, 1/sr. */
SHARED_FUNCTION float ltc_density(vec4 matrix, vec3 v)
{
  vec3 cosine = ltc_transformed(matrix, v);
  float length_sq = max(dot(cosine, cosine), 1e-18f);
  float determinant = matrix.x * matrix.w - matrix.y * matrix.z;
  return INV_PI * max(cosine.z, 0.0f) * abs(determinant) / (length_sq * length_sq);
}

/**
 * Limit of the correction by the ratio of the lobe to the transformed cosine. The cosine is fitted at the lobe's peak and falls
 * much faster far from it.
 */
SHARED_CONSTANT float LTC_RATIO_MAX = 32.0f;

/**
 * Part of the transformed cosine above the surface's horizon that a lamp covers, in [0, 1]. \a flux: z of flat_flux of the transformed
 * lamp.
 */
SHARED_FUNCTION float ltc_covered(vec4 matrix, float flux)
{
  // Both planes of flat_flux leave a wedge of directions.
  vec3 up = ltc_up(matrix);
  float above = 0.5f + 0.5f * up.z / max(sqrt(dot(up, up)), 1e-18f);
  return min(flux / max(above, 1e-6f), 1.0f);
}

/** Directional albedo of the lobe. \a albedo: from the table, for Fresnel terms of 1, and weighted by Schlick's fifth power. */
SHARED_FUNCTION vec3 specular_albedo(vec4 albedo, vec3 f0, float f90)
{
  return f0 * (albedo.x - albedo.y) + vec3(f90 * albedo.y);
}

SHARED_END

#endif
