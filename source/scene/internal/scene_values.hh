// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

/** Values that vertices may have. Internal to source/scene. */
namespace gnomon::scene {

/** Index of the first of \a values with a component that is not \a allowed; empty: there is none. */
[[nodiscard]] std::optional<std::size_t> first_not(const auto &values, auto &&allowed)
{
  // Almost always all are, and a loop without an early end is several times as fast.
  bool are_all = true;
  const auto is_allowed = [&](const auto &value) {
    bool is_it = true;
    for (glm::length_t i = 0; i < value.length(); i++) {
      is_it &= allowed(value[i]);
    }
    return is_it;
  };
  for (const auto &value : values) {
    are_all &= is_allowed(value);
  }
  return are_all ? std::nullopt
                 : std::optional(std::size_t(std::ranges::find_if_not(values, is_allowed) - values.begin()));
}

/** The first index of a value with a component that is not finite. */
[[nodiscard]] std::optional<std::size_t> first_infinite(const auto &values)
{
  return first_not(values, [](float number) { return std::abs(number) <= std::numeric_limits<float>::max(); });
}

/** The first index of a colour with a component that is not from 0 to 1. */
[[nodiscard]] std::optional<std::size_t> first_beyond_one(const auto &colors)
{
  // One operation without branches; both are false for NaN.
  return first_not(colors, [](float number) { return bool(int(number >= 0.0F) & int(number <= 1.0F)); });
}

}  // namespace gnomon::scene
