// SPDX-License-Identifier: MIT
#include "internal/reference_tree.hh"

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace gnomon::reference {

double largest(const glm::dvec3 &v)
{
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

namespace {

bool is_finite(const glm::dvec3 &v)
{
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/**
 * Margin of the boxes in the tree. Coordinates in the tree are at most 1, and a ray in its box is at most 2·√3 long.
 * Rounding the origin and unit direction of such a ray to float moves its points by at most 2^-24 + 3.5 · 2^-25, and
 * the corner of a box by 2^-25. The sum is about an eighth of this margin.
 */
constexpr double tree_margin = 0x1p-20;

float rounded_up(double value)
{
  return std::nextafter(float(value), std::numeric_limits<float>::infinity());
}

float rounded_down(double value)
{
  return std::nextafter(float(value), -std::numeric_limits<float>::infinity());
}

}  // namespace

void Tracer::Tree::fail(const std::string &reason) const
{
  throw std::runtime_error(fmt::format("{}: cannot build the ray tracing tree: {}", scene.path, reason));
}

double Tracer::Tree::opacity_at(const Triangle &triangle, const glm::dvec3 &weights) const
{
  const scene::Material &material = material_of(triangle);
  switch (material.alpha_mode) {
    case scene::AlphaMode::Mask:
      return point_on(triangle, weights).base_color().a >= double(material.alpha_cutoff) ? 1.0 : 0.0;
    case scene::AlphaMode::Blend: return std::clamp(point_on(triangle, weights).base_color().a, 0.0, 1.0);
    default: return 1.0;
  }
}

void Tracer::Tree::add_object(std::uint32_t index)
{
  const scene::Mesh &mesh = scene.meshes()[objects[index].mesh];
  if (mesh.topology != scene::Topology::Triangles) {
    return;
  }
  const glm::dmat4 &world_from_object = objects[index].world_from_object;
  const bool is_mirrored = glm::determinant(glm::dmat3(world_from_object)) < 0.0;
  std::vector<glm::dvec3> positions;
  std::vector<double> errors;
  positions.reserve(mesh.positions.size());
  errors.reserve(mesh.positions.size());
  for (const glm::vec3 &position : mesh.positions) {
    const glm::dvec3 p(position);
    positions.emplace_back(world_from_object * glm::dvec4(p, 1.0));
    // Products of two floats are exact in double. Only the three sums are rounded, with terms of at most this
    // magnitude.
    const glm::dvec3 terms =
        glm::abs(glm::dvec3(world_from_object[0]) * p.x) + glm::abs(glm::dvec3(world_from_object[1]) * p.y) +
        glm::abs(glm::dvec3(world_from_object[2]) * p.z) + glm::abs(glm::dvec3(world_from_object[3]));
    // √3, because each axis has this error. Doubled for points between the corners.
    errors.push_back(2.0 * std::sqrt(3.0) * 3.0 * double_rounding * largest(terms));
  }
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    Triangle triangle;
    triangle.object = index;
    triangle.vertices = {mesh.indices[i], mesh.indices[i + (is_mirrored ? 2 : 1)],
                         mesh.indices[i + (is_mirrored ? 1 : 2)]};
    for (std::size_t k = 0; k < 3; k++) {
      triangle.corners[k] = positions[triangle.vertices[k]];
      triangle.error_m = std::max(triangle.error_m, errors[triangle.vertices[k]]);
    }
    const double area = TrianglePlane(triangle.corners).normal_length;
    if (area > 0.0 && std::isfinite(area)) {
      triangles.push_back(triangle);
    }
  }
}

void Tracer::Tree::place()
{
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec3 high = -low;
  for (const Triangle &triangle : triangles) {
    for (const glm::dvec3 &corner : triangle.corners) {
      low = glm::min(low, corner);
      high = glm::max(high, corner);
      largest_coordinate = std::max(largest_coordinate, largest(corner));
    }
  }
  center = 0.5 * low + 0.5 * high;
  scale = 1.0 / largest(0.5 * high - 0.5 * low);
  half_size = (0.5 * high - 0.5 * low) * scale;
}

void Tracer::Tree::set_bounds(const RTCBoundsFunctionArguments *arguments)
{
  const Tree &self = *static_cast<const Tree *>(arguments->geometryUserPtr);
  const Corners &corners = self.triangles[arguments->primID].corners;
  const glm::dvec3 low = (glm::min(glm::min(corners[0], corners[1]), corners[2]) - self.center) * self.scale;
  const glm::dvec3 high = (glm::max(glm::max(corners[0], corners[1]), corners[2]) - self.center) * self.scale;
  RTCBounds &box = *arguments->bounds_o;
  box.lower_x = rounded_down(low.x - tree_margin);
  box.lower_y = rounded_down(low.y - tree_margin);
  box.lower_z = rounded_down(low.z - tree_margin);
  box.upper_x = rounded_up(high.x + tree_margin);
  box.upper_y = rounded_up(high.y + tree_margin);
  box.upper_z = rounded_up(high.z + tree_margin);
}

void Tracer::Tree::intersect(const RTCIntersectFunctionNArguments *arguments)
{
  const Tree &self = *static_cast<const Tree *>(arguments->geometryUserPtr);
  auto &query = *static_cast<ClosestQuery *>(arguments->context);
  const Triangle &triangle = self.triangles[arguments->primID];
  const std::optional<glm::dvec3> weights = line_triangle(query.sheared, triangle.corners);
  if (!weights) {
    return;
  }
  const TrianglePlane plane(triangle.corners);
  const double rise = glm::dot(plane.normal, query.ray.direction_ws);
  const double t = -plane.height(query.ray.origin_ws) / rise;
  // Written so that NaN is outside the range.
  if (!(t >= query.ray.t_min && t <= query.ray.t_max)) {
    return;
  }
  if (query.best && (t > query.best->t || (t == query.best->t && arguments->primID > query.best->triangle))) {
    return;
  }
  if (query.faces == Faces::Drawn && rise > 0.0 && !self.material_of(triangle).is_double_sided) {
    return;
  }
  if (self.opacity_at(triangle, *weights) == 0.0) {
    return;
  }
  query.best = Hit{t, arguments->primID, *weights};
  // Boxes farther away can be skipped. Boxes at the same distance cannot: they may contain a triangle that comes
  // first.
  RTCRay &ray = reinterpret_cast<RTCRayHit *>(arguments->rayhit)->ray;
  ray.tfar = std::min(ray.tfar, rounded_up((t - query.t_enter) * query.length + tree_margin));
}

void Tracer::Tree::occlude(const RTCOccludedFunctionNArguments *arguments)
{
  const Tree &self = *static_cast<const Tree *>(arguments->geometryUserPtr);
  auto &query = *static_cast<BlockedQuery *>(arguments->context);
  const Triangle &triangle = self.triangles[arguments->primID];
  const std::optional<glm::dvec3> weights = line_triangle(query.sheared, triangle.corners);
  if (!weights) {
    return;
  }
  const TrianglePlane plane(triangle.corners);
  const double height = plane.height(query.point);
  if (!(std::abs(height) > plane.height_error(query.point, query.error_m + triangle.error_m))) {
    return;
  }
  const glm::dvec3 &end = query.light.vector_ws;
  const double end_height = query.light.is_direction ? glm::dot(plane.normal, end) : plane.height(end);
  // A direction has no position error.
  const double end_error = query.light.is_direction ? 16.0 * double_rounding * plane.edge_product * glm::length(end)
                                                    : plane.height_error(end, triangle.error_m);
  const bool is_between = std::abs(end_height) > end_error && (height < 0.0) != (end_height < 0.0);
  if (is_between) {
    query.transmission *= 1.0 - self.opacity_at(triangle, *weights);
  }
  if (query.transmission == 0.0) {
    // Embree's convention for a blocked ray.
    reinterpret_cast<RTCRay *>(arguments->ray)->tfar = -std::numeric_limits<float>::infinity();
  }
}

void Tracer::Tree::build()
{
  if (triangles.empty()) {
    return;
  }
  if (triangles.size() >= RTC_INVALID_GEOMETRY_ID) {
    fail(fmt::format("{} triangles are too many", triangles.size()));
  }
  place();
  device = rtcNewDevice(nullptr);
  if (device == nullptr) {
    fail(fmt::format("Embree error {}", int(rtcGetDeviceError(nullptr))));
  }
  tree = rtcNewScene(device);
  rtcSetSceneFlags(tree, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, unsigned(triangles.size()));
  rtcSetGeometryUserData(geometry, this);

  rtcSetGeometryBoundsFunction(geometry, set_bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, intersect);
  rtcSetGeometryOccludedFunction(geometry, occlude);

  rtcCommitGeometry(geometry);
  rtcAttachGeometry(tree, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(tree);
  if (const RTCError error = rtcGetDeviceError(device); error != RTC_ERROR_NONE) {
    fail(fmt::format("Embree error {}", int(error)));
  }
}

std::optional<Tracer::Tree::Clipped> Tracer::Tree::clipped(const Ray &ray) const
{
  if (tree == nullptr || !is_finite(ray.origin_ws) || !is_finite(ray.direction_ws) ||
      ray.direction_ws == glm::dvec3(0.0)) {
    return std::nullopt;
  }
  const glm::dvec3 origin = (ray.origin_ws - center) * scale;
  const glm::dvec3 direction = ray.direction_ws * scale;
  double enter = ray.t_min;
  double leave = ray.t_max;
  for (int axis = 0; axis < 3; axis++) {
    const double bound = half_size[axis] + tree_margin;
    if (direction[axis] == 0.0) {
      if (std::abs(origin[axis]) > bound) {
        return std::nullopt;
      }
      continue;
    }
    const double a = (-bound - origin[axis]) / direction[axis];
    const double b = (bound - origin[axis]) / direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  if (!(enter <= leave)) {
    return std::nullopt;
  }
  Clipped result;
  result.t_enter = enter;
  result.length = glm::length(direction);
  const glm::dvec3 start = origin + direction * enter;
  const glm::dvec3 unit = direction / result.length;
  RTCRay &out = result.ray;
  out.org_x = float(start.x);
  out.org_y = float(start.y);
  out.org_z = float(start.z);
  out.dir_x = float(unit.x);
  out.dir_y = float(unit.y);
  out.dir_z = float(unit.z);
  out.tnear = 0.0F;
  out.tfar = rounded_up((leave - enter) * result.length + tree_margin);
  out.mask = 0xFFFFFFFFU;
  return result;
}

}  // namespace gnomon::reference
