// SPDX-License-Identifier: MIT
// Exponential shadow maps (Annen et al. 2008), filtered as logarithms (Salvi 2008): log(Σ w·exp(c·z)) / c, of distances z in
// metres and an exponent c in 1/m. Only differences from the farthest distance reach exp(), so no spread overflows.
#ifndef EEVEE_ESM_SHARED_H
#define EEVEE_ESM_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** EsmData::format: what the array that holds the lamp's layer stores. */
/** Metres, in 32 bits. */
#define ESM_FLOAT 0
/** 16 bits: the range is laid over [-1, 1] in equal steps. */
#define ESM_HALF 1

/** One lamp's octahedral layer, an entry of `esm_block`. */
struct EsmData {
  /** 1/m, 0.01 to 1e4. */
  float exponent;
  /** Scale of esm_bias; 1: as derived. */
  float bias;
  /** What was not drawn, and what lies beyond, is at this distance, metres. */
  float range;
  /** Half the opening of the filter's cone, radians. */
  float filter_angle;
  /** Edge of the map, texels, without its border. The map stands in its layer's lower left corner. */
  int size;
  int layer;
  /** ESM_… */
  int format;
  int _pad0;
};
SHARED_ASSERT_SIZE(EsmData, 32)

/** One for each light at most. */
#define ESM_MAX 255

struct EsmBlock {
  EsmData lamps[ESM_MAX];
};
SHARED_ASSERT_SIZE(EsmBlock, ESM_MAX * 32)
SHARED_ASSERT(sizeof(EsmBlock) <= UNIFORM_BLOCK_BYTES_MAX)

/** Texels around a map that continue it, so that four neighbours are found at its edges too. */
#define ESM_BORDER 1

/** Σ w·exp(c·z) as exp(c · highest) · sum. */
struct LogSum {
  /** The largest z so far, metres. */
  float highest;
  /** Σ w·exp(c · (z - highest)): at least the weight of the largest, at most all weights. */
  float sum;
};

/** Of one value. \a weight above 0. */
SHARED_FUNCTION LogSum log_sum_begin(float value, float weight)
{
  LogSum begun;
  begun.highest = value;
  begun.sum = weight;
  return begun;
}

/** With one value more. \a exponent, 1/m: the same at each step. \a weight above 0. Spreads may be 1e30 m at exponents of 1e4. */
SHARED_FUNCTION LogSum log_sum_add(LogSum before, float exponent, float value, float weight)
{
  float scale = exp(-exponent * abs(value - before.highest));
  LogSum after;
  after.highest = max(before.highest, value);
  after.sum = value > before.highest ? before.sum * scale + weight : before.sum + weight * scale;
  return after;
}

/**
 * The filtered distance, metres: between the smallest and the largest value where weights add up to 1. Roundings of
 * the sum weigh 1 / exponent: about 1e-7 m / exponent.
 */
SHARED_FUNCTION float log_sum_value(LogSum total, float exponent)
{
  return total.highest + log(max(total.sum, 1e-30f)) / exponent;
}

/** Visibility in [0, 1] of a receiver at \a distance behind casters at \a stored, metres: exp(c · (stored - distance)), 1 in front. */
SHARED_FUNCTION float esm_visibility(float exponent, float stored, float distance)
{
  return exp(min(exponent * (stored - distance), 0.0f));
}

/** Steps from -1 to 0 that a half has everywhere in [-1, 1]: 11 bits. */
SHARED_CONSTANT float ESM_HALF_STEPS = 2048.0f;

/**
 * What a layer of ESM_… \a format holds for \a distance in [0, \a range], metres. Halves are rounded here to what they hold exactly,
 * because drivers may cut them off instead.
 */
SHARED_FUNCTION float esm_encoded(float distance, float range, int format)
{
  return format == ESM_HALF ? floor(2.0f * ESM_HALF_STEPS * (distance / range) + 0.5f) / ESM_HALF_STEPS - 1.0f : distance;
}

/** The inverse. */
SHARED_FUNCTION float esm_decoded(float stored, float range, int format)
{
  return format == ESM_HALF ? (0.5f * stored + 0.5f) * range : stored;
}

/** Largest error of distances that the format makes, metres: half a step. Roundings of floats are esm_bias' business. */
SHARED_FUNCTION float esm_format_error(float range, int format)
{
  return format == ESM_HALF ? range * (0.25f / ESM_HALF_STEPS) : 0.0f;
}

/**
 * Largest error of visibilities that an error of distances, metres, makes: where 1 becomes exp(-c·e), or the reverse.
 */
SHARED_FUNCTION float esm_visibility_error(float exponent, float distance_error)
{
  return 1.0f - exp(-exponent * distance_error);
}

/**
 * The \a index-th of \a count points that fill the unit disk evenly: Vogel's spiral (1979) in four turns of 90°, so that the points' mean
 * is the middle and their second moments are the disk's. \a count 1, the middle, or a multiple of 4.
 */
SHARED_FUNCTION vec2 esm_disk_point(int index, int count)
{
  if (count == 1) {
    return vec2(0.0f);
  }
  int ring = index / 4;
  int turn = index - 4 * ring;
  float radius = sqrt((float(ring) + 0.5f) / float(count / 4));
  // The golden angle, radians.
  float angle = 2.39996323f * float(ring);
  vec2 p = vec2(radius * cos(angle), radius * sin(angle));
  p = turn >= 2 ? -p : p;
  return turn == 1 || turn == 3 ? vec2(-p.y, p.x) : p;
}

/**
 * Unit vector of the cone around \a axis for a \a point of the unit disk: equal areas become equal solid angles.
 *
 * \a axis: unit vector. \a versine: 1 - cos of half the opening, in [0, 2].
 */
SHARED_FUNCTION vec3 esm_cone_direction(vec3 axis, vec2 point, float versine)
{
  // Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
  float side = axis.z >= 0.0f ? 1.0f : -1.0f;
  float a = -1.0f / (side + axis.z);
  float b = axis.x * axis.y * a;
  vec3 across = vec3(1.0f + side * axis.x * axis.x * a, side * b, -side * axis.x);
  vec3 up = vec3(b, side + axis.y * axis.y * a, -axis.y);
  // sin² = (1 - cos)·(1 + cos), where 1 - cos grows with the radius' square.
  float drop = versine * dot(point, point);
  float sine_a_radius = sqrt(versine * max(2.0f - drop, 0.0f));
  return (1.0f - drop) * axis + sine_a_radius * point.x * across + sine_a_radius * point.y * up;
}

/** Planes seen more edge-on than this tangent are not lifted further: 84°. */
SHARED_CONSTANT float ESM_TANGENT_MAX = 10.0f;

/**
 * How far to lift a receiver towards the lamp, metres, so that a lit plane does not darken itself: the four texels around it
 * see the plane up to a texel nearer, and distances are rounded.
 *
 * \a cosine: between the plane's normal and the direction to the lamp, in [-1, 1]. \a texel_angle: edge of a texel there,
 * radians. \a format_error: metres.
 */
SHARED_FUNCTION float esm_bias(float distance, float cosine, float texel_angle, float format_error)
{
  float cosine_abs = min(abs(cosine), 1.0f);
  float tangent = sqrt(max(1.0f - cosine_abs * cosine_abs, 0.0f)) / max(cosine_abs, 1e-30f);
  return distance * (texel_angle * min(tangent, ESM_TANGENT_MAX) + 4e-7f) + format_error;
}

/**
 * Bilinear share of what the four texels around a lookup let through, in the order of textureGather: (0, 1), (1, 1), (1, 0),
 * (0, 0). Visibilities are blended, not distances: blended distances are geometric means of visibilities, and where a
 * near texel stands beside a far one, shadow would reach up to a texel too far.
 *
 * \a stored: distances, metres. \a fraction: of the lookup between the texel centres, in [0, 1).
 */
SHARED_FUNCTION float esm_gathered_visibility(float exponent, vec4 stored, float distance, vec2 fraction)
{
  float low = mix(esm_visibility(exponent, stored.w, distance), esm_visibility(exponent, stored.z, distance), fraction.x);
  float high = mix(esm_visibility(exponent, stored.x, distance), esm_visibility(exponent, stored.y, distance), fraction.x);
  return mix(low, high, fraction.y);
}

SHARED_END

#endif
