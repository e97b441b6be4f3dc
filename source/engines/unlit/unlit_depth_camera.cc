// SPDX-License-Identifier: MIT
#include "unlit_depth_camera.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::unlit {

namespace {

/** Field of view for point and area lamps, radians: 60 degrees. */
constexpr float wide_angle = 1.0471976F;

/** The matrix of a camera at \a lamp that looks at \a middle. */
glm::dmat4 turned(const scene::PlacedLamp &lamp, const glm::dvec3 &middle)
{
  const glm::dvec3 position(lamp.world_from_lamp[3]);
  const glm::dvec3 forward = middle - position;
  if (!(glm::length(forward) > 0.0)) {
    return lamp.world_from_lamp;
  }
  const glm::dvec3 up = std::abs(glm::normalize(forward).y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  return glm::inverse(glm::lookAt(position, middle, up));
}

}  // namespace

std::optional<scene::PlacedCamera> depth_camera_of(const scene::PlacedLamp &lamp, const scene::Bounds &bounds_ws)
{
  const float radius = bounds_ws.radius();
  if (lamp.kind == scene::LampKind::Hemi || bounds_ws.is_empty() || !(radius > 0.0F)) {
    return std::nullopt;
  }
  const glm::dvec3 middle(bounds_ws.center());
  scene::PlacedCamera camera;
  camera.name = lamp.name;
  camera.node = lamp.node;
  camera.aspect = 1.0F;
  camera.world_from_camera = lamp.world_from_lamp;
  if (lamp.kind == scene::LampKind::Sun) {
    camera.kind = scene::CameraKind::Orthographic;
    camera.half_width = camera.half_height = radius;
    camera.near = 0.5F * radius;
    camera.far = 2.5F * radius;
    const glm::dvec3 back(lamp.world_from_lamp[2]);
    camera.world_from_camera[3] = glm::dvec4(middle + 1.5 * double(radius) * back, 1.0);
    return camera;
  }
  camera.near = 0.01F * radius;
  if (lamp.kind == scene::LampKind::Spot) {
    // A perspective view must be narrower than π.
    camera.vertical_angle = std::min(2.0F * lamp.spot_outer_angle, 3.0F);
  }
  else {
    camera.vertical_angle = wide_angle;
    camera.world_from_camera = turned(lamp, middle);
  }
  return camera;
}

}  // namespace gnomon::unlit
