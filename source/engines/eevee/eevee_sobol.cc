// SPDX-License-Identifier: MIT
#include "eevee_sobol.hh"

#include "eevee_sequence_shared.h"

#include <array>
#include <cmath>
#include <numbers>

namespace gnomon::eevee {

namespace {

using shared::mixed_bits;
using shared::reversed_bits;
using shared::scrambled;
using shared::to_unit;

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

glm::dvec2 on_disk(const glm::dvec2 &place)
{
  constexpr double pi = std::numbers::pi;
  const glm::dvec2 square = 2.0 * place - 1.0;
  if (square.x == 0.0 && square.y == 0.0) {
    return {0.0, 0.0};
  }
  const bool is_wide = std::abs(square.x) > std::abs(square.y);
  const double radius = is_wide ? square.x : square.y;
  const double angle = is_wide ? 0.25 * pi * (square.y / square.x) : 0.5 * pi - 0.25 * pi * (square.x / square.y);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace gnomon::eevee
