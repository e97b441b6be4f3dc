// SPDX-License-Identifier: MIT
// Exponential shadow maps (Annen et al. 2008), filtered as logarithms (Salvi 2008): log(Σ w·exp(c·z)) / c, of distances z in
// metres and an exponent c in 1/m. Only differences from the farthest distance reach exp(), so no spread overflows.
#ifndef EEVEE_ESM_SHARED_H
#define EEVEE_ESM_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

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

SHARED_END

#endif
