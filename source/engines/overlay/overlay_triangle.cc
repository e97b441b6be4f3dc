// SPDX-License-Identifier: MIT
#include "overlay_triangle.hh"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace gnomon::overlay {

namespace {

/** Two corners and the origin span twice this area, in the plane across a ray. */
double area(const glm::dvec3 &a, const glm::dvec3 &b)
{
  return a.x * b.y - a.y * b.x;
}

/** Rows: two unit vectors across a ray, and one along it; right-handed. */
glm::dmat3 ray_from_world(const glm::dvec3 &direction_ws)
{
  const glm::dvec3 along = glm::normalize(direction_ws);
  const glm::dvec3 other = std::abs(along.x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 across = glm::normalize(glm::cross(other, along));
  return glm::transpose(glm::dmat3(across, glm::cross(along, across), along));
}

template <typename T>
T interpolated(const scene::Mesh &mesh, const std::vector<T> &stream, const TrianglePoint &point)
{
  T sum(0.0F);
  for (int corner = 0; corner < 3; corner++) {
    sum += float(point.barycentric[corner]) * stream[mesh.indices[3 * point.index + std::uint32_t(corner)]];
  }
  return sum;
}

}  // namespace

std::optional<TrianglePoint> triangle_at(const scene::Mesh &mesh, const glm::dmat4 &world_from_mesh,
                                         bool is_double_sided, const glm::dvec3 &direction_ws, glm::dvec3 &position_ws)
{
  if (mesh.topology != scene::Topology::Triangles) {
    return std::nullopt;
  }
  // The origin is the point of the ray, and z is along it.
  const glm::dmat3 rows = ray_from_world(direction_ws);
  const glm::dmat3 linear = rows * glm::dmat3(world_from_mesh);
  const glm::dvec3 origin = rows * (glm::dvec3(world_from_mesh[3]) - position_ws);
  std::vector<glm::dvec3> positions;
  positions.reserve(mesh.positions.size());
  for (const glm::vec3 &position : mesh.positions) {
    positions.push_back(linear * glm::dvec3(position) + origin);
  }
  const double front = draw::is_mirrored(glm::mat4(world_from_mesh)) ? -1.0 : 1.0;
  // The nearest to the point that was drawn, not the nearest to the eye: a mask may have cut that out. Triangles beside
  // the ray count, too, as the device rounds positions, and may draw a pixel that the exact triangle does not contain.
  // The depth of a pixel is less exact than its ray, most of all in parallel pictures.
  constexpr double across_weight = 1000.0;
  std::optional<TrianglePoint> nearest;
  double nearest_distance = std::numeric_limits<double>::infinity();
  for (std::size_t index = 0; index < mesh.indices.size() / 3; index++) {
    const glm::dvec3 &a = positions[mesh.indices[3 * index]];
    const glm::dvec3 &b = positions[mesh.indices[3 * index + 1]];
    const glm::dvec3 &c = positions[mesh.indices[3 * index + 2]];
    const double beside = std::max(
        {std::min({a.x, b.x, c.x}), -std::max({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), -std::max({a.y, b.y, c.y})});
    if (across_weight * beside > nearest_distance) {
      continue;
    }
    const double whole = area(b - a, c - a);
    if (whole == 0.0 || (front * whole > 0.0 && !is_double_sided)) {
      continue;
    }
    glm::dvec3 weights = glm::max(glm::dvec3(area(b, c), area(c, a), area(a, b)) / whole, 0.0);
    weights /= weights.x + weights.y + weights.z;
    const glm::dvec3 met = weights.x * a + weights.y * b + weights.z * c;
    const double distance = std::abs(met.z) + across_weight * std::hypot(met.x, met.y);
    if (distance < nearest_distance) {
      nearest_distance = distance;
      nearest = {.index = std::uint32_t(index), .barycentric = weights};
    }
  }
  if (!nearest) {
    return std::nullopt;
  }
  std::array<glm::dvec3, 3> corners_ws;
  for (std::size_t i = 0; i < 3; i++) {
    const glm::vec3 &corner = mesh.positions[mesh.indices[3 * nearest->index + i]];
    corners_ws[i] = glm::dvec3(world_from_mesh * glm::dvec4(corner, 1.0));
  }
  const glm::dvec3 &weights = nearest->barycentric;
  position_ws = weights.x * corners_ws[0] + weights.y * corners_ws[1] + weights.z * corners_ws[2];
  if (!mesh.uvs.empty()) {
    nearest->uv = interpolated(mesh, mesh.uvs, *nearest);
  }
  const glm::vec3 smooth = draw::normal_matrix(glm::mat4(world_from_mesh)) * interpolated(mesh, mesh.normals, *nearest);
  const glm::dvec3 normal = glm::cross(corners_ws[1] - corners_ws[0], corners_ws[2] - corners_ws[0]);
  const glm::vec3 flat(glm::normalize(front * normal));
  nearest->normal_ws = glm::length(smooth) > 0.0F ? glm::normalize(smooth) : flat;
  return nearest;
}

}  // namespace gnomon::overlay
