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
/** Metres, and the relative variance of what was filtered, in 32 bits each: exponential variance shadow maps. */
#define ESM_VARIANCE 2

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

/**
 * Relative variance of exp(c·z), Σ w·e² / (Σ w·e)² - 1 with e = exp(c·z), for weights that add up to \a weights. Both sums are
 * divided by powers of the largest e, which cancel: whatever the spread, it is at most weights / (weight of the
 * largest) - 1. Roundings of the sums make it wrong by some 1e-7, which is what it is for equal distances instead of 0.
 *
 * \a squares: Σ w·exp(2·c · (z - highest)), as log_sum_add makes it with an exponent of 2·c.
 */
SHARED_FUNCTION float log_sum_variance(LogSum total, LogSum squares, float weights)
{
  return max(squares.sum * weights / max(total.sum * total.sum, 1e-30f) - 1.0f, 0.0f);
}

/** Visibility in [0, 1] of a receiver at \a distance behind casters at \a stored, metres: exp(c · (stored - distance)), 1 in front. */
SHARED_FUNCTION float esm_visibility(float exponent, float stored, float distance)
{
  return exp(min(exponent * (stored - distance), 0.0f));
}

/** Share of Chebyshev's bound that is cut off: light that bleeds through two layers of casters, mostly (Lauritzen and McCool 2008). */
SHARED_CONSTANT float ESM_BLEED = 0.1f;

/**
 * Visibility in [0, 1] by Chebyshev's bound (Donnelly and Lauritzen 2006) for exp(c·z): of a distribution with mean m and relative
 * variance v, v / (v + (exp(c·distance) / m - 1)²) at most is beyond \a distance. With the mean stored as a logarithm
 * only a difference of distances reaches exp().
 *
 * \a stored: log(m) / c, metres. \a variance: at least 0. \a spread: least standard deviation, metres, above 0: that of the receiver's own
 * plane over the texels of a lookup.
 */
SHARED_FUNCTION float esm_variance_visibility(float exponent, float stored, float variance, float distance, float spread)
{
  float beyond = exponent * (distance - stored);
  // Where exp() of 40 is, nothing is seen any more; its square is finite.
  float t = exp(clamp(beyond, 0.0f, 40.0f)) - 1.0f;
  float least = min(exponent * spread, 1.0f);
  float v = max(variance, max(least * least, 1e-6f));
  return max(v / (v + t * t) - ESM_BLEED, 0.0f) / (1.0f - ESM_BLEED);
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
/** What four texels around a lookup see of a plane, and a quarter for the cube's texels, from whose middles they have it. */
SHARED_CONSTANT float ESM_BIAS_TEXELS = 1.25f;

/**
 * How far to lift a receiver towards the lamp, metres, so that a lit plane does not darken itself: the four texels around it
 * see the plane up to ESM_BIAS_TEXELS nearer, and distances are rounded.
 *
 * \a cosine: between the plane's normal and the direction to the lamp, in [-1, 1]. \a texel_angle: edge of a texel there,
 * radians. \a format_error: metres.
 */
SHARED_FUNCTION float esm_bias(float distance, float cosine, float texel_angle, float format_error)
{
  float cosine_abs = min(abs(cosine), 1.0f);
  float tangent = sqrt(max(1.0f - cosine_abs * cosine_abs, 0.0f)) / max(cosine_abs, 1e-30f);
  return distance * (ESM_BIAS_TEXELS * texel_angle * min(tangent, ESM_TANGENT_MAX) + 4e-7f) + format_error;
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

/** The same by esm_variance_visibility. */
SHARED_FUNCTION float esm_gathered_variance_visibility(float exponent, vec4 stored, vec4 variance, float distance, float spread,
                                                       vec2 fraction)
{
  float low = mix(esm_variance_visibility(exponent, stored.w, variance.w, distance, spread),
                  esm_variance_visibility(exponent, stored.z, variance.z, distance, spread), fraction.x);
  float high = mix(esm_variance_visibility(exponent, stored.x, variance.x, distance, spread),
                   esm_variance_visibility(exponent, stored.y, variance.y, distance, spread), fraction.x);
  return mix(low, high, fraction.y);
}

SHARED_END

#endif
