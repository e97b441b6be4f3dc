// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <cstdint>

/** Random numbers that depend only on their key, not on the order of work or on threads. */
namespace gnomon::reference {

/** SplitMix64's output function (Steele, Lea and Flood 2014). */
[[nodiscard]] inline std::uint64_t mixed(std::uint64_t x)
{
  x += 0x9E3779B97F4A7C15U;
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31U);
}

/** Maps \a bits to [0, 1). */
[[nodiscard]] inline double fraction(std::uint64_t bits)
{
  return double(bits >> 11U) * 0x1p-53;
}

/** The fractional part of \a x, in [0, 1). */
[[nodiscard]] inline double fraction(double x)
{
  const double part = x - std::floor(x);
  return part < 1.0 ? part : 0.0;
}

/**
 * Point \a index of an infinite sequence of which every prefix fills the unit square evenly (Roberts 2018: multiples of
 * the inverse of the plastic number and of its square), shifted by \a key.
 */
[[nodiscard]] inline glm::dvec2 even_point(int index, std::uint64_t key)
{
  return {fraction(double(index) * 0.7548776662466927 + fraction(mixed(key))),
          fraction(double(index) * 0.5698402909980532 + fraction(mixed(key + 1)))};
}

/** The same in the unit cube. */
[[nodiscard]] inline glm::dvec3 even_point_in_cube(int index, std::uint64_t key)
{
  return {fraction(double(index) * 0.8191725133961645 + fraction(mixed(key))),
          fraction(double(index) * 0.6710436067037893 + fraction(mixed(key + 1))),
          fraction(double(index) * 0.5497004779019703 + fraction(mixed(key + 2)))};
}

}  // namespace gnomon::reference
