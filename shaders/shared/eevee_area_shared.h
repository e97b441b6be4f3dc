// SPDX-License-Identifier: MIT
#ifndef EEVEE_AREA_SHARED_H
#define EEVEE_AREA_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** Where a line and a plane that hardly meet are said to meet, in lengths of the line's direction: its square is finite. */
SHARED_CONSTANT float LINE_FAR = 1e16f;

/**
 * Along the line, in lengths of \a direction, to the plane. In [-LINE_FAR, LINE_FAR], and LINE_FAR for a parallel.
 *
 * \a origin: a point of the line; \a plane_point: one of the plane. \a plane_normal: of any length.
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

/** Unit vector, or zero for one without length. */
SHARED_FUNCTION vec3 direction_or_zero(vec3 v)
{
  return v / max(sqrt(dot(v, v)), 1e-18f);
}

/**
 * Numerator and denominator of tan(Ω / 2) for the triangle from an apex in direction \a n to two corners (van
 * Oosterom and Strackee 1983). All unit vectors; \a volume: their triple product. No sum here cancels where n is the apex of the
 * quad that is nearest: it has no angle above 90° with a corner.
 */
SHARED_FUNCTION vec2 half_angle_tangent(vec3 n, vec3 corner_a, vec3 corner_b, float volume)
{
  // 1 + a·b = |a + b|² / 2.
  vec3 sum = corner_a + corner_b;
  return vec2(volume, max(dot(sum, vec3(0.5f) * sum + n), 1e-9f));
}

/** Product of the complex numbers y + i·x: adds their angles. */
SHARED_FUNCTION vec2 angles_added(vec2 a, vec2 b)
{
  return vec2(a.x * b.y + a.y * b.x, a.y * b.y - a.x * b.x);
}

/**
 * Solid angle of a rectangle, sr, in [0, 2π]; from both sides alike, and whatever a receiver's horizon hides of it.
 *
 * \a center: from the eye, metres. \a half_right, \a half_up: from there to the middles of two edges, at right angles;
 * sizes from 1e-8 to 1e8 m. 0 where the rectangle has no area or is seen edge-on, 2π for an eye that touches its inside.
 */
SHARED_FUNCTION float rectangle_solid_angle(vec3 center, vec3 half_right, vec3 half_up)
{
  vec3 area = cross(half_right, half_up);
  // The point that is nearest to the eye, in half edges, and the direction of it.
  float s = -dot(center, half_right) / max(dot(half_right, half_right), 1e-30f);
  float t = -dot(center, half_up) / max(dot(half_up, half_up), 1e-30f);
  bool is_above = abs(s) < 1.0f && abs(t) < 1.0f;
  s = clamp(s, -1.0f, 1.0f);
  t = clamp(t, -1.0f, 1.0f);
  vec3 n = direction_or_zero(center + s * half_right + t * half_up);
  if (is_above) {
    // An eye that touches sees a direction of no length; this one stays.
    n = direction_or_zero(area);
    n = dot(n, center) < 0.0f ? -n : n;
  }
  // Four triangles around that point.
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
  // At most π, where rounding could put it below the axis.
  return 2.0f * atan(max(half_angle.x, 0.0f), half_angle.y);
}

SHARED_END

#endif
