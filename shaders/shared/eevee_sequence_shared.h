// SPDX-License-Identifier: MIT
// Low-discrepancy sequences over the samples of a picture. A uint stands for the number in [0, 1) of which it holds the
// fractional bits, so that sums wrap around.
#ifndef EEVEE_SEQUENCE_SHARED_H
#define EEVEE_SEQUENCE_SHARED_H

#include "shared/shared_types.h"

SHARED_BEGIN

/** A hash: mixes the bits of \a value, so that neighbours have unrelated results. */
SHARED_FUNCTION uint mixed_bits(uint value)
{
  // The finalizer of MurmurHash3 (A. Appleby, public domain).
  value ^= value >> 16u;
  value *= 0x85EBCA6Bu;
  value ^= value >> 13u;
  value *= 0xC2B2AE35u;
  value ^= value >> 16u;
  return value;
}

SHARED_FUNCTION uint reversed_bits(uint value)
{
  value = (value >> 16u) | (value << 16u);
  value = ((value >> 8u) & 0x00FF00FFu) | ((value & 0x00FF00FFu) << 8u);
  value = ((value >> 4u) & 0x0F0F0F0Fu) | ((value & 0x0F0F0F0Fu) << 4u);
  value = ((value >> 2u) & 0x33333333u) | ((value & 0x33333333u) << 2u);
  return ((value >> 1u) & 0x55555555u) | ((value & 0x55555555u) << 1u);
}

/**
 * The hash of Laine and Karras (2011), by which Owen scrambling flips bits: each bit of the result depends on lower bits only.
 */
SHARED_FUNCTION uint scrambled_from_below(uint value, uint seed)
{
  value += seed;
  value ^= value * 0x6C50B47Cu;
  value ^= value * 0xB82F1E52u;
  value ^= value * 0xC7AFE638u;
  value ^= value * 0x8D22F6E6u;
  return value;
}

/** Owen scrambling of \a value: a hash of the higher bits decides whether a bit is flipped. */
SHARED_FUNCTION uint scrambled(uint value, uint seed)
{
  return reversed_bits(scrambled_from_below(reversed_bits(value), seed));
}

/**
 * Point \a index of the van der Corput sequence in base 2, Owen-scrambled and in an order shuffled by \a seed: of any 2^k points
 * that start at a multiple of 2^k, one is in each interval of 2^-k. Sequences of different seeds are independent of each other,
 * for which scrambling alone does not suffice (Burley 2020, Practical Hash-based Owen Scrambling).
 */
SHARED_FUNCTION uint scrambled_van_der_corput(uint index, uint seed)
{
  return reversed_bits(scrambled_from_below(scrambled(index, mixed_bits(seed)), seed));
}

/** In [0, 1). */
SHARED_FUNCTION float to_unit(uint value)
{
  return float(value >> 8u) / 16777216.0f;
}

/**
 * Threshold in [0, 1) of the texel (\a x, \a y) of a shadow layer: an occluder blocks the light there where its opacity is above.
 *
 * In the first sample the thresholds of neighbouring texels are spread evenly (a lattice of multiples of the inverse powers of the
 * plastic number, Roberts 2018), so that filtered lookups give the opacity with little noise. Over the samples, those of one texel
 * are. \a occluder: a number of the occluder, by which thresholds of different occluders are independent; in the first
 * sample only of those that differ by less than four.
 */
SHARED_FUNCTION float opacity_threshold(uint x, uint y, uint occluder, uint sample_index, uint seed)
{
  // Four lattices: swapped and mirrored.
  uint across = (occluder & 1u) == 0u ? 3242174889u : 2447445414u;
  uint up = (occluder & 1u) == 0u ? 2447445414u : 3242174889u;
  across = (occluder & 2u) == 0u ? across : 0u - across;
  uint lattice = across * x + up * y + mixed_bits(occluder + seed);
  uint stream = mixed_bits(mixed_bits(mixed_bits(mixed_bits(occluder) + x) + y) + seed);
  return to_unit(lattice + scrambled_van_der_corput(sample_index, stream) - scrambled_van_der_corput(0u, stream));
}

SHARED_END

#endif
