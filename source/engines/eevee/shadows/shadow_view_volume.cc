// SPDX-License-Identifier: MIT
#include "shadow_view_volume.hh"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory_resource>
#include <utility>

namespace gnomon::eevee {

namespace {

/** The many small polygons use one memory resource, which frees them together. */
using Polygon = std::pmr::vector<glm::dvec3>;
using Polygons = std::pmr::vector<Polygon>;

Polygons box_faces(const scene::Bounds &bounds, std::pmr::memory_resource &resource)
{
  std::array<glm::dvec3, 8> corners;
  for (int i = 0; i < 8; i++) {
    corners[std::size_t(i)] = {(i & 1) ? bounds.max.x : bounds.min.x, (i & 2) ? bounds.max.y : bounds.min.y,
                               (i & 4) ? bounds.max.z : bounds.min.z};
  }
  Polygons faces(&resource);
  for (const auto &face : {std::array{0, 1, 3, 2}, std::array{4, 5, 7, 6}, std::array{0, 1, 5, 4},
                           std::array{2, 3, 7, 6}, std::array{0, 2, 6, 4}, std::array{1, 3, 7, 5}}) {
    Polygon &polygon = faces.emplace_back();
    for (const int corner : face) {
      polygon.push_back(corners[std::size_t(corner)]);
    }
  }
  return faces;
}

/** Clips a polygon by a plane (Sutherland and Hodgman 1974). Appends the intersections of edges and plane to \a cut. */
Polygon clipped(const Polygon &polygon, const glm::dvec4 &plane, Polygon &cut)
{
  Polygon inside(polygon.get_allocator());
  const auto height = [&](const glm::dvec3 &point) { return glm::dot(glm::dvec3(plane), point) + plane.w; };
  for (std::size_t i = 0; i < polygon.size(); i++) {
    const glm::dvec3 &a = polygon[i];
    const glm::dvec3 &b = polygon[(i + 1) % polygon.size()];
    const double height_a = height(a);
    const double height_b = height(b);
    if (height_a >= 0.0) {
      inside.push_back(a);
    }
    if ((height_a >= 0.0) != (height_b >= 0.0)) {
      const glm::dvec3 crossing = glm::mix(a, b, height_a / (height_a - height_b));
      inside.push_back(crossing);
      cut.push_back(crossing);
    }
  }
  return inside;
}

/** Sort the points of a convex polygon by their angle around the centre. */
void sort_around(Polygon &points, const glm::dvec3 &normal)
{
  glm::dvec3 middle(0.0);
  for (const glm::dvec3 &point : points) {
    middle += point / double(points.size());
  }
  const glm::dvec3 helper = std::abs(normal.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 x = glm::cross(helper, normal);
  const glm::dvec3 y = glm::cross(normal, x);
  const auto angle = [&](const glm::dvec3 &p) { return std::atan2(glm::dot(p - middle, y), glm::dot(p - middle, x)); };
  std::ranges::sort(points, {}, angle);
}

}  // namespace

std::vector<glm::dvec3> visible_corners(const draw::View &view, const scene::Bounds &bounds,
                                        std::vector<glm::dvec3> memory)
{
  std::vector<glm::dvec3> corners = std::move(memory);
  corners.clear();
  if (bounds.is_empty()) {
    return corners;
  }
  std::array<std::byte, std::size_t(1) << 16U> buffer;
  std::pmr::monotonic_buffer_resource resource(buffer.data(), buffer.size());
  Polygons faces = box_faces(bounds, resource);
  for (const glm::vec4 &plane : view.frustum_planes_ws()) {
    Polygon cut(&resource);
    for (Polygon &face : faces) {
      face = clipped(face, glm::dvec4(plane), cut);
    }
    // The face in the clipping plane closes the solid, so that the next plane can clip it.
    sort_around(cut, glm::dvec3(plane));
    faces.push_back(std::move(cut));
    std::erase_if(faces, [](const Polygon &face) { return face.empty(); });
  }
  for (const Polygon &face : faces) {
    corners.insert(corners.end(), face.begin(), face.end());
  }
  return corners;
}

}  // namespace gnomon::eevee
