// SPDX-License-Identifier: MIT
// The G-buffer: the properties of a surface that deferred lighting reads, in one texel of four floats. They are, in this order: the
// shading normal and the normal of the triangle, both on the visible side; the entry of material_block, and above it, as a half float, the
// change of the shading normal from pixel to pixel: the root of the sum of the squares of that to the right and that up, or 0 if nothing
// reflects specularly; and the depth of gbuffer_depth(). \see filtered_alpha
#ifndef EEVEE_GBUFFER_SHARED_H
#define EEVEE_GBUFFER_SHARED_H

#include "shared/eevee_octahedral_shared.h"
#include "shared/shared_types.h"

SHARED_BEGIN

/** Bits and largest entry of material_block in the G-buffer. Materials beyond it are lit forward. */
SHARED_CONSTANT uint GBUFFER_MATERIAL_BITS = 15u;
SHARED_CONSTANT uint GBUFFER_MATERIAL_MAX = (1u << GBUFFER_MATERIAL_BITS) - 1u;

/** Steps of each coordinate of a stored direction on the octahedral map. They are even in number, so that axes are exact. */
SHARED_CONSTANT float GBUFFER_STEPS = 32766.0f;

/**
 * A float with the lower 30 bits of \a bits. It is finite and not denormalized, so that no device changes it: bit 29 is its sign, and its
 * exponent begins with the bits 01.
 */
SHARED_FUNCTION float gbuffer_float(uint bits)
{
  return uintBitsToFloat((bits & 0x1fffffffu) | 0x20000000u | ((bits << 2u) & 0x80000000u));
}

/** The 30 bits of a gbuffer_float(). */
SHARED_FUNCTION uint gbuffer_bits(float stored)
{
  uint bits = floatBitsToUint(stored);
  return (bits & 0x1fffffffu) | ((bits >> 2u) & 0x20000000u);
}

/** \a v: of any length. */
SHARED_FUNCTION float gbuffer_from_direction(vec3 v)
{
  vec2 steps = GBUFFER_STEPS * octahedral_from_direction(v) + vec2(0.5f);
  return gbuffer_float(uint(steps.x) | (uint(steps.y) << 15u));
}

/** The unit vector of a gbuffer_from_direction(). */
SHARED_FUNCTION vec3 gbuffer_to_direction(float stored)
{
  uint bits = gbuffer_bits(stored);
  return octahedral_to_direction(vec2(float(bits & 0x7fffu), float(bits >> 15u)) / GBUFFER_STEPS);
}

SHARED_END

#endif
