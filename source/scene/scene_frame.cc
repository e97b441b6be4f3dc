// SPDX-License-Identifier: MIT
#include "scene.hh"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace gnomon::scene {

namespace {

/** \a vector at length 1; nothing when it has no direction to speak of. */
std::optional<glm::dvec3> direction(const glm::dvec3 &vector, double length_least)
{
  const double length = glm::length(vector);
  return length > length_least ? std::optional(vector / length) : std::nullopt;
}

/** The part of the unit vector \a vector that is at right angles to the unit vector \a axis, at length 1. */
std::optional<glm::dvec3> direction_across(const std::optional<glm::dvec3> &vector, const glm::dvec3 &axis)
{
  constexpr double nearly_parallel = 1e-6;
  return vector ? direction(*vector - axis * glm::dot(*vector, axis), nearly_parallel) : std::nullopt;
}

glm::dvec3 any_across(const glm::dvec3 &axis)
{
  const glm::dvec3 least = std::abs(axis.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  return *direction_across(least, axis);
}

/** z from what is left when its own axis is gone. */
glm::dvec3 replaced_z(const std::optional<glm::dvec3> &x, const std::optional<glm::dvec3> &y)
{
  if (!x && !y) {
    return {0, 0, 1};
  }
  if (x && y) {
    if (const auto across = direction_across(y, *x)) {
      return glm::cross(*x, *across);
    }
  }
  return any_across(x ? *x : *y);
}

}  // namespace

glm::dmat4 frame_of(const glm::dmat4 &world)
{
  // Relative, so that a model in micrometres keeps its axes.
  const auto axis = [&world](int column) {
    const glm::dvec3 vector(world[column]);
    const double size = std::max({std::abs(vector.x), std::abs(vector.y), std::abs(vector.z)});
    return size > 0.0 ? direction(vector / size, 0.0) : std::nullopt;
  };
  const auto x_given = axis(0);
  const auto y_given = axis(1);
  const glm::dvec3 z = axis(2).value_or(replaced_z(x_given, y_given));
  glm::dvec3 y;
  if (const auto across = direction_across(y_given, z)) {
    y = *across;
  }
  else if (const auto x_across = direction_across(x_given, z)) {
    y = glm::cross(z, *x_across);
  }
  else {
    y = any_across(z);
  }
  const glm::dvec3 x = glm::cross(y, z);
  return {glm::dvec4(x, 0.0), glm::dvec4(y, 0.0), glm::dvec4(z, 0.0), world[3]};
}

}  // namespace gnomon::scene
