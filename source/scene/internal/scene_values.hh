// SPDX-License-Identifier: MIT
#pragma once

#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <limits>
#include <optional>

/** Values that vertices may have. Internal to source/scene. */
namespace gnomon::scene {

/** False for NaN. */
template <glm::length_t L>
[[nodiscard]] bool is_finite(const glm::vec<L, float> &value)
{
  return glm::all(glm::lessThanEqual(glm::abs(value), glm::vec<L, float>(std::numeric_limits<float>::max())));
}

/** Index of the first of \a values with a component that is not finite; empty: there is none. */
[[nodiscard]] std::optional<std::size_t> first_infinite(const auto &values)
{
  const auto found = std::ranges::find_if_not(values, [](const auto &value) { return is_finite(value); });
  return found == values.end() ? std::nullopt : std::optional(std::size_t(found - values.begin()));
}

/** Index of the first of \a colors with a component that is not from 0 to 1; empty: there is none. */
[[nodiscard]] std::optional<std::size_t> first_beyond_one(const auto &colors)
{
  const auto found = std::ranges::find_if_not(colors, [](const glm::vec4 &color) {
    return glm::all(glm::greaterThanEqual(color, glm::vec4(0.0F))) &&
           glm::all(glm::lessThanEqual(color, glm::vec4(1.0F)));
  });
  return found == colors.end() ? std::nullopt : std::optional(std::size_t(found - colors.begin()));
}

}  // namespace gnomon::scene
