// SPDX-License-Identifier: MIT
// Octahedral map of directions to the unit square: the octahedron |x| + |y| + |z| = 1 is seen along -Z, and its lower half is
// unfolded into the corners. +Z is the centre; -Z is all four corners (Cigolle et al. 2014, "A Survey of Efficient
// Representations for Independent Unit Vectors").
#ifndef EEVEE_OCTAHEDRAL_SHARED_H
#define EEVEE_OCTAHEDRAL_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** 1 or -1. Both zeros give 1: GLSL's sign() would return 0 for them, which loses the fold. */
SHARED_FUNCTION float octahedral_sign(float x)
{
  return x >= 0.0f ? 1.0f : -1.0f;
}

/** Point in [0, 1]² for the direction of \a v. The length of \a v is arbitrary; the zero vector maps to +Z. */
SHARED_FUNCTION vec2 octahedral_from_direction(vec3 v)
{
  float norm = abs(v.x) + abs(v.y) + abs(v.z);
  vec2 p = vec2(v.x, v.y) / max(norm, 1e-30f);
  if (v.z < 0.0f) {
    p = vec2((1.0f - abs(p.y)) * octahedral_sign(p.x), (1.0f - abs(p.x)) * octahedral_sign(p.y));
  }
  return vec2(0.5f) * p + vec2(0.5f);
}

/** Unit vector for a point in [0, 1]². */
SHARED_FUNCTION vec3 octahedral_to_direction(vec2 uv)
{
  vec2 p = vec2(2.0f) * uv - vec2(1.0f);
  float z = 1.0f - abs(p.x) - abs(p.y);
  float fold = max(-z, 0.0f);
  vec3 v = vec3(p.x - octahedral_sign(p.x) * fold, p.y - octahedral_sign(p.y) * fold, z);
  // The distance of a point on the octahedron from the centre is at least 1 / √3, so the divisor is not 0.
  return v / sqrt(dot(v, v));
}

/**
 * Solid angle of a texel around \a direction, relative to a texel on an axis: 1 on the axes, up to 3√3 on the diagonals. All
 * texels have the same area on the octahedron; at distance r from the centre, their solid angle is proportional to 1 / r³.
 * \a direction: unit vector.
 */
SHARED_FUNCTION float octahedral_texel_weight(vec3 direction)
{
  float inverse = abs(direction.x) + abs(direction.y) + abs(direction.z);
  return inverse * inverse * inverse;
}

/**
 * Edge of a square with the solid angle of a texel, radians, for a map of \a size² texels: between 2 / size and 4.56 / size.
 * \a direction: unit vector.
 */
SHARED_FUNCTION float octahedral_texel_angle(vec3 direction, int size)
{
  return 2.0f / float(size) * sqrt(octahedral_texel_weight(direction));
}

/**
 * The texel of a map of \a size² that continues the map at \a texel, which may lie up to one map size outside: the content of
 * the border around the map. Beyond an edge, the map continues rotated by 180° about the middle of that edge. Beyond a
 * corner, it continues from the opposite corner.
 */
SHARED_FUNCTION ivec2 octahedral_texel(ivec2 texel, int size)
{
  int last = size - 1;
  if (texel.x < 0 || texel.x > last) {
    texel = ivec2(texel.x < 0 ? -1 - texel.x : size + last - texel.x, last - texel.y);
  }
  if (texel.y < 0 || texel.y > last) {
    texel = ivec2(last - texel.x, texel.y < 0 ? -1 - texel.y : size + last - texel.y);
  }
  return texel;
}

SHARED_END

#endif
