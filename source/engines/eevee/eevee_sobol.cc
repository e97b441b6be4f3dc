// SPDX-License-Identifier: MIT
#include "eevee_sobol.hh"

#include <array>

namespace gnomon::eevee {

std::uint32_t mixed_bits(std::uint32_t value)
{
  // The finalizer of MurmurHash3 (A. Appleby, public domain).
  value ^= value >> 16U;
  value *= 0x85EBCA6BU;
  value ^= value >> 13U;
  value *= 0xC2B2AE35U;
  value ^= value >> 16U;
  return value;
}

namespace {

std::uint32_t reversed_bits(std::uint32_t value)
{
  value = (value >> 16U) | (value << 16U);
  value = ((value >> 8U) & 0x00FF00FFU) | ((value & 0x00FF00FFU) << 8U);
  value = ((value >> 4U) & 0x0F0F0F0FU) | ((value & 0x0F0F0F0FU) << 4U);
  value = ((value >> 2U) & 0x33333333U) | ((value & 0x33333333U) << 2U);
  return ((value >> 1U) & 0x55555555U) | ((value & 0x55555555U) << 1U);
}

/** Owen scrambling of \a value: a hash of the higher bits decides whether a bit is flipped. */
std::uint32_t scrambled(std::uint32_t value, std::uint32_t seed)
{
  // The hash of Laine and Karras (2011) on the reversed bits. In each of its steps, a bit depends on lower bits only.
  value = reversed_bits(value);
  value += seed;
  value ^= value * 0x6C50B47CU;
  value ^= value * 0xB82F1E52U;
  value ^= value * 0xC7AFE638U;
  value ^= value * 0x8D22F6E6U;
  return reversed_bits(value);
}

using Directions = std::array<std::uint32_t, 32>;

constexpr Directions directions_of_second()
{
  Directions directions{};
  directions[0] = 1U << 31U;
  for (std::size_t k = 1; k < directions.size(); k++) {
    directions[k] = directions[k - 1] ^ (directions[k - 1] >> 1U);
  }
  return directions;
}

constexpr Directions directions_of_third()
{
  Directions directions{};
  directions[0] = 1U << 31U;
  directions[1] = 3U << 30U;
  for (std::size_t k = 2; k < directions.size(); k++) {
    directions[k] = directions[k - 1] ^ directions[k - 2] ^ (directions[k - 2] >> 2U);
  }
  return directions;
}

std::uint32_t sobol(std::uint32_t index, const Directions &directions)
{
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < directions.size(); k++) {
    value ^= (index >> k & 1U) != 0 ? directions[k] : 0U;
  }
  return value;
}

float to_unit(std::uint32_t value)
{
  return float(value >> 8U) * 0x1p-24F;
}

}  // namespace

glm::vec3 sobol_point(std::uint32_t index, std::uint32_t seed)
{
  constexpr Directions second = directions_of_second();
  constexpr Directions third = directions_of_third();
  const auto seed_of = [seed](std::uint32_t dimension) { return mixed_bits(4U * mixed_bits(seed) + dimension); };
  const std::uint32_t shuffled = scrambled(index, seed_of(0));
  return {to_unit(scrambled(reversed_bits(shuffled), seed_of(1))),
          to_unit(scrambled(sobol(shuffled, second), seed_of(2))),
          to_unit(scrambled(sobol(shuffled, third), seed_of(3)))};
}

}  // namespace gnomon::eevee
