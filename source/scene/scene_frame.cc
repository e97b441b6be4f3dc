// SPDX-License-Identifier: MIT
#include "scene.hh"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace gnomon::scene {

namespace {

/** \a vector normalised; empty if it is not longer than \a length_least. */
std::optional<glm::dvec3> direction(const glm::dvec3 &vector, double length_least)
{
  const double length = glm::length(vector);
  return length > length_least ? std::optional(vector / length) : std::nullopt;
}

/**
 * The component of the unit vector \a vector orthogonal to the unit vector \a axis, normalised; empty if they are
 * nearly parallel.
 */
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

/** Direction of z from the other axes, for a matrix whose z axis has no length. */
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
  // Relative, so that small scales keep their axes.
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

glm::dvec3 scale_of(const glm::dmat4 &world)
{
  glm::dvec3 lengths;
  for (int column = 0; column < 3; column++) {
    const glm::dvec3 axis(world[column]);
    const double size = std::max({std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)});
    // Relative, so that squares neither overflow nor underflow.
    const double length = size > 0.0 ? size * glm::length(axis / size) : 0.0;
    lengths[column] = std::min(length, std::numeric_limits<double>::max());
  }
  return lengths;
}

glm::dvec2 area_half_size(const PlacedLamp &lamp)
{
  // Squares of these lengths and their inverses are finite in float.
  constexpr double least = 1e-9;
  constexpr double most = 1e9;
  const glm::dvec2 half_size =
      0.5 * glm::dvec2(lamp.area_size_x, lamp.area_size_y) * glm::dvec2(lamp.scale.x, lamp.scale.y);
  const bool is_area = std::min(half_size.x, half_size.y) >= least && std::max(half_size.x, half_size.y) <= most;
  return is_area ? half_size : glm::dvec2(0.0);
}

double area_of(const PlacedLamp &lamp)
{
  const glm::dvec2 half_size = area_half_size(lamp);
  return (lamp.area_shape == AreaShape::Ellipse ? std::numbers::pi : 4.0) * half_size.x * half_size.y;
}

glm::dvec2 spot_scale(const PlacedLamp &lamp)
{
  if (!(std::min({lamp.scale.x, lamp.scale.y, lamp.scale.z}) > 0.0)) {
    return glm::dvec2(1.0);
  }
  constexpr double limit = 1000.0;
  const auto ratio = [&](double across) {
    const double wide = across / lamp.scale.z;
    // Ignores rounding errors of the matrix, because a round cone is cheaper.
    return std::abs(wide - 1.0) < 1e-6 ? 1.0 : std::clamp(wide, 1.0 / limit, limit);
  };
  return {ratio(lamp.scale.x), ratio(lamp.scale.y)};
}

double spot_blend(double inner, double outer)
{
  // (cos inner - cos outer) / (1 - cos outer), from half angles without cancellation in narrow cones.
  const double scale = std::sin(0.5 * outer);
  const double blend = std::sin(0.5 * (outer + inner)) / scale * (std::sin(0.5 * (outer - inner)) / scale);
  return std::clamp(blend, 0.0, 1.0);
}

}  // namespace gnomon::scene
