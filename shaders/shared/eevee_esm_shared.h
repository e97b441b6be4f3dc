// SPDX-License-Identifier: MIT
// Exponential shadow maps (Annen et al. 2008), filtered in log space (Salvi 2008): log(Σ w·exp(c·z)) / c for distances z in
// metres and an exponent c in 1/m. The argument of exp() is always a difference from the farthest distance, so that no spread
// of distances overflows.
#ifndef EEVEE_ESM_SHARED_H
#define EEVEE_ESM_SHARED_H

#include "shared/eevee_disk_shared.h"
#include "shared/shared_types.h"

SHARED_BEGIN

/** EsmData::format: the format of the array that contains the lamp's layer. */
/** Distances in metres, in 32 bits. */
#define ESM_FLOAT 0
/** Distances in 16 bits: the range is mapped to [-1, 1] in equal steps. */
#define ESM_HALF 1
/** Distances in metres and their relative variance, in 32 bits each: exponential variance shadow maps. */
#define ESM_VARIANCE 2

/** The octahedral layer of a lamp: an entry of `esm_block`. */
struct EsmData {
  /** Exponent, 1/m, 0.01 to 1e4. */
  float exponent;
  /** Factor of esm_bias. 1: the derived bias. */
  float bias;
  /** Distance that is stored for empty texels and for all that is farther, metres. */
  float range;
  /** Half the opening angle of the filter cone, radians. */
  float filter_angle;
  /** Edge of the map, texels, without its border. The map is in the lower left corner of its layer. */
  int size;
  int layer;
  /** ESM_… */
  int format;
  int _pad0;
};
SHARED_ASSERT_SIZE(EsmData, 32)

/** At most one for each light. */
#define ESM_MAX 255

struct EsmBlock {
  EsmData lamps[ESM_MAX];
};
SHARED_ASSERT_SIZE(EsmBlock, ESM_MAX * 32)
SHARED_ASSERT(sizeof(EsmBlock) <= UNIFORM_BLOCK_BYTES_MAX)

/** Width of the border that continues a map, texels, so that lookups at its edges have four neighbours. */
#define ESM_BORDER 1

/** Σ w·exp(c·z), represented as exp(c · highest) · sum. */
struct LogSum {
  /** The largest z so far, metres. */
  float highest;
  /** Σ w·exp(c · (z - highest)): at least the weight of the largest z, at most the sum of the weights. */
  float sum;
};

/** Sum of one value. \a weight: above 0. */
SHARED_FUNCTION LogSum log_sum_begin(float value, float weight)
{
  LogSum begun;
  begun.highest = value;
  begun.sum = weight;
  return begun;
}

/**
 * Adds a value. \a exponent: 1/m, the same in each step. \a weight: above 0. Spreads up to 1e30 m are valid with exponents up to
 * 1e4.
 */
SHARED_FUNCTION LogSum log_sum_add(LogSum before, float exponent, float value, float weight)
{
  float scale = exp(-exponent * abs(value - before.highest));
  LogSum after;
  after.highest = max(before.highest, value);
  after.sum = value > before.highest ? before.sum * scale + weight : before.sum + weight * scale;
  return after;
}

/**
 * The filtered distance, metres. It lies between the smallest and the largest value if the weights add up to 1. Rounding of the
 * sum contributes an error of about 1e-7 / exponent.
 */
SHARED_FUNCTION float log_sum_value(LogSum total, float exponent)
{
  return total.highest + log(max(total.sum, 1e-30f)) / exponent;
}

/**
 * Relative variance of e = exp(c·z): Σ w·e² / (Σ w·e)² - 1, for weights that add up to \a weights. Both sums are divided by powers
 * of the largest e, which cancel, so that the result is at most weights / (weight of the largest) - 1 for every spread. Rounding
 * of the sums causes an error of about 1e-7; equal distances give this value instead of 0.
 *
 * \a squares: Σ w·exp(2·c · (z - highest)), from log_sum_add with an exponent of 2·c.
 */
SHARED_FUNCTION float log_sum_variance(LogSum total, LogSum squares, float weights)
{
  return max(squares.sum * weights / max(total.sum * total.sum, 1e-30f) - 1.0f, 0.0f);
}

/**
 * Visibility in [0, 1] of a receiver at \a distance for casters at \a stored, metres: exp(c · (stored - distance)), and 1 for a
 * receiver in front of the casters.
 */
SHARED_FUNCTION float esm_visibility(float exponent, float stored, float distance)
{
  return exp(min(exponent * (stored - distance), 0.0f));
}

/** Fraction of Chebyshev's bound that is cut off to reduce light bleeding behind two layers of casters (Lauritzen and McCool 2008). */
SHARED_CONSTANT float ESM_BLEED = 0.1f;

/**
 * Visibility in [0, 1] by Chebyshev's bound (Donnelly and Lauritzen 2006) for exp(c·z). Of a distribution with mean m and relative
 * variance v, at most v / (v + (exp(c·distance) / m - 1)²) lies beyond \a distance. The mean is stored as a logarithm, so that the
 * argument of exp() is a difference of distances.
 *
 * \a stored: log(m) / c, metres. \a variance: at least 0. \a spread: least standard deviation, metres, above 0: that of the
 * receiver's own plane over the texels of a lookup.
 */
SHARED_FUNCTION float esm_variance_visibility(float exponent, float stored, float variance, float distance, float spread)
{
  float beyond = exponent * (distance - stored);
  // At exp(40) the visibility is 0, and the square of exp(40) is finite.
  float t = exp(clamp(beyond, 0.0f, 40.0f)) - 1.0f;
  float least = min(exponent * spread, 1.0f);
  float v = max(variance, max(least * least, 1e-6f));
  return max(v / (v + t * t) - ESM_BLEED, 0.0f) / (1.0f - ESM_BLEED);
}

/** Number of steps from -1 to 0 that half floats resolve everywhere in [-1, 1]: 11 bits. */
SHARED_CONSTANT float ESM_HALF_STEPS = 2048.0f;

/**
 * Value that a layer of \a format (ESM_…) stores for \a distance in [0, \a range], metres. Half floats are rounded here to
 * representable values, because drivers may truncate.
 */
SHARED_FUNCTION float esm_encoded(float distance, float range, int format)
{
  return format == ESM_HALF ? floor(2.0f * ESM_HALF_STEPS * (distance / range) + 0.5f) / ESM_HALF_STEPS - 1.0f : distance;
}

/** The inverse of esm_encoded: metres. */
SHARED_FUNCTION float esm_decoded(float stored, float range, int format)
{
  return format == ESM_HALF ? (0.5f * stored + 0.5f) * range : stored;
}

/** Largest error of distances due to the format, metres: half a step. Rounding of floats is included in esm_bias instead. */
SHARED_FUNCTION float esm_format_error(float range, int format)
{
  return format == ESM_HALF ? range * (0.25f / ESM_HALF_STEPS) : 0.0f;
}

/** Largest error of visibilities due to an error e of distances, metres: the difference between 1 and exp(-c·e). */
SHARED_FUNCTION float esm_visibility_error(float exponent, float distance_error)
{
  return 1.0f - exp(-exponent * distance_error);
}

/**
 * Point \a index of \a count points that fill the unit disk evenly: a Vogel disk, repeated in four rotations of 90°, so that
 * the mean of the points is the centre and their second moments are those of the disk. \a count: 1 (the centre) or a multiple of 4.
 */
SHARED_FUNCTION vec2 esm_disk_point(int index, int count)
{
  if (count == 1) {
    return vec2(0.0f);
  }
  int ring = index / 4;
  int turn = index - 4 * ring;
  vec2 p = vogel_disk(ring, count / 4);
  p = turn >= 2 ? -p : p;
  return turn == 1 || turn == 3 ? vec2(-p.y, p.x) : p;
}

/**
 * Unit vector in the cone around \a axis for a \a point of the unit disk. Equal areas map to equal solid angles.
 *
 * \a axis: unit vector. \a versine: 1 - cos of half the opening angle, in [0, 2].
 */
SHARED_FUNCTION vec3 esm_cone_direction(vec3 axis, vec2 point, float versine)
{
  // Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
  float side = axis.z >= 0.0f ? 1.0f : -1.0f;
  float a = -1.0f / (side + axis.z);
  float b = axis.x * axis.y * a;
  vec3 across = vec3(1.0f + side * axis.x * axis.x * a, side * b, -side * axis.x);
  vec3 up = vec3(b, side + axis.y * axis.y * a, -axis.y);
  // sin² = (1 - cos)·(1 + cos). 1 - cos is proportional to the square of the radius.
  float drop = versine * dot(point, point);
  float sine_a_radius = sqrt(versine * max(2.0f - drop, 0.0f));
  return (1.0f - drop) * axis + sine_a_radius * point.x * across + sine_a_radius * point.y * up;
}

/** Largest tangent of the incidence angle for which the bias grows: 84°. */
SHARED_CONSTANT float ESM_TANGENT_MAX = 10.0f;
/** Bias in texels: 1 for the four texels around a lookup, and 0.25 for the sampling at the centres of the cube's texels. */
SHARED_CONSTANT float ESM_BIAS_TEXELS = 1.25f;

/**
 * Distance by which a receiver is moved towards the lamp, metres, so that a lit plane does not shadow itself. The four texels
 * around the lookup store the plane at distances up to ESM_BIAS_TEXELS nearer, and distances are rounded.
 *
 * \a cosine: between the plane's normal and the direction to the lamp, in [-1, 1]. \a texel_angle: edge of a texel at the
 * receiver, radians. \a format_error: metres.
 */
SHARED_FUNCTION float esm_bias(float distance, float cosine, float texel_angle, float format_error)
{
  float cosine_abs = min(abs(cosine), 1.0f);
  float tangent = sqrt(max(1.0f - cosine_abs * cosine_abs, 0.0f)) / max(cosine_abs, 1e-30f);
  return distance * (ESM_BIAS_TEXELS * texel_angle * min(tangent, ESM_TANGENT_MAX) + 4e-7f) + format_error;
}

/**
 * Bilinear blend of the visibilities of the four texels around a lookup, in the order of textureGather: (0, 1), (1, 1), (1, 0),
 * (0, 0). Visibilities are blended, not distances. Blended distances give geometric means of visibilities, and a near texel
 * beside a far one would extend the shadow by up to a texel.
 *
 * \a stored: distances, metres. \a fraction: position of the lookup between the texel centres, in [0, 1).
 */
SHARED_FUNCTION float esm_gathered_visibility(float exponent, vec4 stored, float distance, vec2 fraction)
{
  float low = mix(esm_visibility(exponent, stored.w, distance), esm_visibility(exponent, stored.z, distance), fraction.x);
  float high = mix(esm_visibility(exponent, stored.x, distance), esm_visibility(exponent, stored.y, distance), fraction.x);
  return mix(low, high, fraction.y);
}

/** The same with esm_variance_visibility. */
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
