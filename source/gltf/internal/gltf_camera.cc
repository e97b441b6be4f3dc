// SPDX-License-Identifier: MIT
#include "internal/gltf_camera.hh"

#include "internal/gltf_extra.hh"
#include "internal/gltf_node.hh"
#include "internal/gltf_units.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

namespace gnomon::gltf {

using scene::Bounds;
using scene::Camera;
using scene::CameraKind;
using scene::LampKind;
using scene::PlacedCamera;
using scene::PlacedLamp;

namespace {

using std::numbers::pi;

/** Describes an invalid number of a camera; empty if there is none. Checks the floats that will be used. */
std::string camera_fault(const Camera &camera)
{
  const bool is_perspective = camera.kind == CameraKind::Perspective;
  std::string fault;
  Camera::for_each_property([&](const auto &row) {
    if (row.path.empty() || !row.has_kind(unsigned(camera.kind))) {
      return;
    }
    scene::for_each_number(camera.*row.member, [&](double value) {
      // No view begins behind the camera, and a perspective one not at it.
      const Range range =
          row.name != "near" ? range_of(row) : Range{is_perspective ? scene::smallest_length : 0.0, row.max};
      if (fault.empty() && !range.contains(value)) {
        const std::string_view member = row.path.substr(row.path.rfind('/') + 1);
        fault = std::string(member) + ' ' + text(value) + " must be " + range.text();
      }
    });
  });
  const bool is_infinite = is_perspective && camera.far == 0.0F;
  if (fault.empty() && !is_infinite && !(camera.far > camera.near)) {
    fault = "zfar " + text(camera.far) + " is not above znear " + text(camera.near);
  }
  return fault;
}

/**
 * Converts to float. Values out of range become float's limits, which the checks refuse; a plain cast would be
 * undefined. A value other than 0 remains other than 0, which has a special meaning.
 */
float narrowed(double value)
{
  constexpr double max = std::numeric_limits<float>::max();
  constexpr double least = std::numeric_limits<float>::denorm_min();
  return static_cast<float>(std::copysign(std::clamp(std::abs(value), value == 0.0 ? 0.0 : least, max), value));
}

/** A camera or lamp matrix with the view direction \a forward, a unit vector. */
glm::dmat4 looking(const glm::dvec3 &position, const glm::dvec3 &forward, const glm::dvec3 &up)
{
  const glm::dmat4 skewed(glm::dvec4(0.0), glm::dvec4(up, 0.0), glm::dvec4(-forward, 0.0), glm::dvec4(position, 1.0));
  return scene::frame_of(skewed);
}

}  // namespace

bool is_camera_extra(std::string_view key)
{
  bool is_extra = false;
  Camera::for_each_property([&](const auto &row) { is_extra |= row.extra_kinds != 0 && extra_key(row) == key; });
  return is_extra;
}

std::optional<Camera> camera_on(const File &file, int node_index, Warnings &warnings)
{
  const Model::Node &node = file.model.nodes[node_index];
  if (node.camera < 0) {
    return std::nullopt;
  }
  const Model::Camera &source = file.model.cameras[node.camera];
  Camera camera;
  camera.name = thing_name(node, "gnomon_camera_name", source.name, "camera", node_index);
  if (source.is_perspective) {
    camera.vertical_angle = narrowed(source.yfov);
    camera.aspect = narrowed(source.aspect_ratio);
    camera.near = narrowed(source.znear);
    camera.far = narrowed(source.zfar);
  }
  else {
    camera.kind = CameraKind::Orthographic;
    camera.half_width = narrowed(source.xmag);
    camera.half_height = narrowed(source.ymag);
    camera.near = narrowed(source.znear);
    camera.far = narrowed(source.zfar);
  }
  const std::string what = "camera '" + printable(camera.name) + '\'';
  if (const std::string fault = camera_fault(camera); !fault.empty()) {
    warnings.add(what, "left out: " + fault);
    return std::nullopt;
  }
  ExtraReader(node.extras, what).read_properties(unsigned(camera.kind), camera);
  Camera::for_each_property([&](const auto &row) {
    if (row.extra_kinds != 0 && !row.has_extra(unsigned(camera.kind)) && node.extras.count(extra_key(row)) > 0) {
      warnings.add(what, "extra '" + extra_key(row) + "' does not apply to this kind of camera");
    }
  });
  return camera;
}

PlacedCamera default_camera(const Bounds &bounds)
{
  PlacedCamera camera;
  camera.name = default_name;
  const glm::dvec3 center = bounds.is_empty() ? glm::dvec3(0.0) : glm::dvec3(bounds.center());
  // At least the spacing of floats at the scene's position, and at least the smallest length.
  const double reach = glm::length(center);
  const double radius =
      bounds.is_empty() ? 1.0 : std::max({double(bounds.radius()), 1e-6 * reach, 1e3 * scene::smallest_length});
  const glm::dvec3 half =
      bounds.is_empty() ? glm::dvec3(radius) : glm::max(0.5 * glm::dvec3(bounds.max - bounds.min), 1e-3 * radius);
  const glm::dvec3 forward = glm::normalize(glm::dvec3(-0.6, -0.45, -1.0));
  const glm::dmat4 axes = looking(center, forward, {0, 1, 0});
  // The box around the scene fits, with a margin, into a frame that is at least as wide as high.
  const double slope = std::tan(0.5 * double(camera.vertical_angle)) / 1.12;
  glm::dvec2 low(std::numeric_limits<double>::infinity());
  glm::dvec2 high(-low);
  double nearest = 0.0;
  for (int corner = 0; corner < 8; corner++) {
    const glm::dvec3 from_center((corner & 1) != 0 ? half.x : -half.x, (corner & 2) != 0 ? half.y : -half.y,
                                 (corner & 4) != 0 ? half.z : -half.z);
    const glm::dvec3 at(glm::transpose(glm::dmat3(axes)) * from_center);
    // At the distance d from the centre's plane, the view reaches to (d - z) · slope.
    low = glm::min(low, glm::dvec2(at) - at.z * slope);
    high = glm::max(high, glm::dvec2(at) + at.z * slope);
    nearest = std::max(nearest, at.z);
  }
  const glm::dvec2 middle = 0.5 * (low + high);
  const glm::dvec2 size = 0.5 * (high - low);
  const double distance = std::max(std::max(size.x, size.y) / slope, nearest + 0.1 * radius);
  const glm::dvec3 position(axes * glm::dvec4(middle, distance, 1.0));
  camera.world_from_camera = looking(position, forward, {0, 1, 0});
  camera.near = static_cast<float>(0.5 * (distance - nearest));
  camera.far = static_cast<float>(distance + 2.0 * radius);
  return camera;
}

PlacedLamp default_sun(const PlacedCamera &camera)
{
  PlacedLamp sun;
  sun.name = default_name;
  sun.kind = LampKind::Sun;
  // A white surface that faces the sun has radiance 1.
  sun.intensity = static_cast<float>(pi);
  const glm::dmat4 &view = camera.world_from_camera;
  const glm::dvec3 right(view[0]);
  const glm::dvec3 up(view[1]);
  const glm::dvec3 forward = -glm::dvec3(view[2]);
  // From above and from the left of the camera.
  sun.world_from_lamp = looking(glm::dvec3(view[3]), glm::normalize(forward + 0.5 * right - 0.8 * up), up);
  return sun;
}

}  // namespace gnomon::gltf
