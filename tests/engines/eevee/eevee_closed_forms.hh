// SPDX-License-Identifier: MIT
#pragma once

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

/** Closed forms of the light of lamps with an extent. */
namespace gnomon::test {

/** Irradiance of a polygon of radiance 1 on a surface that faces +z: half the sum over its edges of angle times normal
 * (Lambert 1760). \pre the polygon is above the horizon */
inline double lambert_irradiance(const std::vector<glm::dvec3> &corners, const glm::dvec3 &position_ws)
{
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); i++) {
    const glm::dvec3 a = glm::normalize(corners[i] - position_ws);
    const glm::dvec3 b = glm::normalize(corners[(i + 1) % corners.size()] - position_ws);
    const glm::dvec3 normal = glm::cross(a, b);
    const double sine = glm::length(normal);
    sum += std::atan2(sine, glm::dot(a, b)) * normal.z / sine;
  }
  return std::abs(0.5 * sum);
}

inline std::vector<glm::dvec3> rectangle_corners(const glm::dvec3 &center, const glm::dvec3 &axis_x,
                                                 const glm::dvec3 &axis_y)
{
  return {center + axis_x + axis_y, center - axis_x + axis_y, center - axis_x - axis_y, center + axis_x - axis_y};
}

/** So many corners that the polygon's irradiance is the ellipse's to 1e-7. */
inline std::vector<glm::dvec3> ellipse_corners(const glm::dvec3 &center, const glm::dvec3 &axis_x,
                                               const glm::dvec3 &axis_y)
{
  std::vector<glm::dvec3> corners;
  constexpr int count = 20000;
  for (int i = 0; i < count; i++) {
    const double turn = 2.0 * std::numbers::pi * i / count;
    corners.push_back(center + std::cos(turn) * axis_x + std::sin(turn) * axis_y);
  }
  return corners;
}

}  // namespace gnomon::test
