// SPDX-License-Identifier: MIT
// Directions on a square: |x| + |y| + |z| = 1 seen along -Z, its lower half folded out over the corners. +Z is the centre,
// -Z all four corners (Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit Vectors").
#ifndef EEVEE_OCTAHEDRAL_SHARED_H
#define EEVEE_OCTAHEDRAL_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** 1 or -1, and 1 for both zeros, where GLSL's sign() would give 0 and lose the fold. */
SHARED_FUNCTION float octahedral_sign(float x)
{
  return x >= 0.0f ? 1.0f : -1.0f;
}

/** Point of [0, 1]² for the direction of \a v, of any length. A vector of no length stands for +Z. */
SHARED_FUNCTION vec2 octahedral_from_direction(vec3 v)
{
  float norm = abs(v.x) + abs(v.y) + abs(v.z);
  vec2 p = vec2(v.x, v.y) / max(norm, 1e-30f);
  if (v.z < 0.0f) {
    p = vec2((1.0f - abs(p.y)) * octahedral_sign(p.x), (1.0f - abs(p.x)) * octahedral_sign(p.y));
  }
  return vec2(0.5f) * p + vec2(0.5f);
}

/** Unit vector for a point of [0, 1]². */
SHARED_FUNCTION vec3 octahedral_to_direction(vec2 uv)
{
  vec2 p = vec2(2.0f) * uv - vec2(1.0f);
  float z = 1.0f - abs(p.x) - abs(p.y);
  float fold = max(-z, 0.0f);
  vec3 v = vec3(p.x - octahedral_sign(p.x) * fold, p.y - octahedral_sign(p.y) * fold, z);
  // On the octahedron no point is nearer to the middle than 1 / √3.
  return v / sqrt(dot(v, v));
}

/**
 * Solid angle of a texel around \a direction, in those of the texels on the axes: 1 there, to 3√3 on the diagonals. On the
 * octahedron all texels are equal; r from the middle, they are seen under 1 / r³ of that. \a direction: unit vector.
 */
SHARED_FUNCTION float octahedral_texel_weight(vec3 direction)
{
  float inverse = abs(direction.x) + abs(direction.y) + abs(direction.z);
  return inverse * inverse * inverse;
}

/** Edge of a square as large as a texel of a map of \a size², radians: between 2 / size and 4.56 / size. \a direction: unit vector. */
SHARED_FUNCTION float octahedral_texel_angle(vec3 direction, int size)
{
  return 2.0f / float(size) * sqrt(octahedral_texel_weight(direction));
}

/**
 * The texel of a map of \a size² that continues it at \a texel, up to a whole map outside: what a border around the map holds.
 * Past an edge the map goes on turned by 180° around that edge's middle; past a corner, from the opposite corner.
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
