// SPDX-License-Identifier: MIT
#include "internal/reference_triangle.hh"

#include <glm/geometric.hpp>

#include <cmath>

namespace gnomon::reference {

ShearedRay::ShearedRay(const glm::dvec3 &origin_, const glm::dvec3 &direction_) : origin(origin_), direction(direction_)
{
  const glm::dvec3 size = glm::abs(direction);
  z = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
  x = (z + 1) % 3;
  y = (x + 1) % 3;
  shear_x = direction[x] / direction[z];
  shear_y = direction[y] / direction[z];
}

std::optional<glm::dvec3> line_triangle(const ShearedRay &ray, const Corners &corners)
{
  std::array<double, 3> px{};
  std::array<double, 3> py{};
  for (std::size_t i = 0; i < 3; i++) {
    const glm::dvec3 p = corners[i] - ray.origin;
    px[i] = p[ray.x] - ray.shear_x * p[ray.z];
    py[i] = p[ray.y] - ray.shear_y * p[ray.z];
  }
  const double u = px[2] * py[1] - py[2] * px[1];
  const double v = px[0] * py[2] - py[0] * px[2];
  const double w = px[1] * py[0] - py[1] * px[0];
  if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) {
    return std::nullopt;
  }
  const double sum = u + v + w;
  // The triangle is edge-on, or its area underflows: it covers nothing.
  if (sum == 0.0 || !std::isfinite(sum)) {
    return std::nullopt;
  }
  return glm::dvec3(u, v, w) / sum;
}

TrianglePlane::TrianglePlane(const Corners &corners) : point(corners[0])
{
  const glm::dvec3 edge_b = corners[1] - corners[0];
  const glm::dvec3 edge_c = corners[2] - corners[0];
  normal = glm::cross(edge_b, edge_c);
  normal_length = glm::length(normal);
  edge_product = glm::length(edge_b) * glm::length(edge_c);
}

double TrianglePlane::height(const glm::dvec3 &p) const
{
  return glm::dot(normal, p - point);
}

double TrianglePlane::height_error(const glm::dvec3 &p, double error_m) const
{
  // Subtractions, a cross product and a dot product: fewer than 16 successive roundings.
  return normal_length * error_m + 16.0 * double_rounding * edge_product * glm::length(p - point);
}

}  // namespace gnomon::reference
