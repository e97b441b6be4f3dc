// SPDX-License-Identifier: MIT
#ifndef EEVEE_AREA_SHARED_H
#define EEVEE_AREA_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** Largest result of line_plane_distance, in lengths of the line's direction. Its square is finite. */
SHARED_CONSTANT float LINE_FAR = 1e16f;

/**
 * Distance from \a origin along a line to a plane, in lengths of \a direction. The result is in [-LINE_FAR, LINE_FAR], and
 * LINE_FAR for a parallel line.
 *
 * \a origin: a point on the line. \a plane_point: a point on the plane. \a plane_normal: of any length.
 */
SHARED_FUNCTION float line_plane_distance(vec3 origin, vec3 direction, vec3 plane_point, vec3 plane_normal)
{
  float height = dot(plane_normal, plane_point - origin);
  float rise = dot(plane_normal, direction);
  if (abs(height) < LINE_FAR * abs(rise)) {
    return height / rise;
  }
  return (height < 0.0f) == (rise < 0.0f) ? LINE_FAR : -LINE_FAR;
}

/** Unit vector in the direction of \a v; the zero vector for the zero vector. */
SHARED_FUNCTION vec3 direction_or_zero(vec3 v)
{
  return v / max(sqrt(dot(v, v)), 1e-18f);
}

/**
 * Numerator and denominator of tan(Ω / 2), with Ω the solid angle of the triangle between direction \a n and two corners
 * (van Oosterom and Strackee 1983). All three are unit vectors; \a volume is their triple product. If \a n points to the
 * nearest point of the quad, its angle with each corner is at most 90° and no sum cancels.
 */
SHARED_FUNCTION vec2 half_angle_tangent(vec3 n, vec3 corner_a, vec3 corner_b, float volume)
{
  // 1 + a·b = |a + b|² / 2.
  vec3 sum = corner_a + corner_b;
  return vec2(volume, max(dot(sum, vec3(0.5f) * sum + n), 1e-9f));
}

/** Adds the angles of two complex numbers y + i·x by multiplying them. */
SHARED_FUNCTION vec2 angles_added(vec2 a, vec2 b)
{
  return vec2(a.x * b.y + a.y * b.x, a.y * b.y - a.x * b.x);
}

/**
 * Solid angle of a rectangle, sr, in [0, 2π]. It is the same from both sides, and is not clipped to a receiver's horizon.
 *
 * \a center: the centre relative to the eye, metres. \a half_right, \a half_up: from the centre to the middles of two edges;
 * they are orthogonal, and 1e-8 to 1e8 m long. The result is 0 for a rectangle without area or seen edge-on, and 2π if the
 * eye lies on its interior.
 */
SHARED_FUNCTION float rectangle_solid_angle(vec3 center, vec3 half_right, vec3 half_up)
{
  vec3 area = cross(half_right, half_up);
  // The point nearest to the eye, in half edges, and its direction.
  float s = -dot(center, half_right) / max(dot(half_right, half_right), 1e-30f);
  float t = -dot(center, half_up) / max(dot(half_up, half_up), 1e-30f);
  bool is_above = abs(s) < 1.0f && abs(t) < 1.0f;
  s = clamp(s, -1.0f, 1.0f);
  t = clamp(t, -1.0f, 1.0f);
  vec3 n = direction_or_zero(center + s * half_right + t * half_up);
  if (is_above) {
    // For an eye on the rectangle that direction has no length. The normal is always defined.
    n = direction_or_zero(area);
    n = dot(n, center) < 0.0f ? -n : n;
  }
  // The four triangles around that point.
  vec3 a = center - half_right - half_up;
  vec3 b = center + half_right - half_up;
  vec3 c = center + half_right + half_up;
  vec3 d = center - half_right + half_up;
  vec4 inverse = vec4(1.0f) / max(sqrt(vec4(dot(a, a), dot(b, b), dot(c, c), dot(d, d))), vec4(1e-18f));
  a = a * inverse.x;
  b = b * inverse.y;
  c = c * inverse.z;
  d = d * inverse.w;
  float volume = 2.0f * abs(dot(n, area));
  vec2 low = half_angle_tangent(n, a, b, volume * (1.0f + t) * (inverse.x * inverse.y));
  vec2 right = half_angle_tangent(n, b, c, volume * (1.0f - s) * (inverse.y * inverse.z));
  vec2 high = half_angle_tangent(n, c, d, volume * (1.0f - t) * (inverse.z * inverse.w));
  vec2 left = half_angle_tangent(n, d, a, volume * (1.0f + s) * (inverse.w * inverse.x));
  vec2 half_angle = angles_added(angles_added(low, right), angles_added(high, left));
  // The sum of half angles is at most π. Rounding may give a negative numerator.
  return 2.0f * atan(max(half_angle.x, 0.0f), half_angle.y);
}

SHARED_END

#endif
