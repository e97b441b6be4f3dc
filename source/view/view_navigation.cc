// SPDX-License-Identifier: MIT
#include "view_navigation.hh"

#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::view {

namespace {

/** Limits of the distance. The camera's numbers lose precision beyond them. */
constexpr double distance_min = 1e-4;
constexpr double distance_max = 1e9;

}  // namespace

double Navigation::half_height() const
{
  return distance_ * std::tan(0.5 * double(vertical_angle_));
}

void Navigation::look_through(const scene::PlacedCamera &camera, const scene::Bounds &bounds)
{
  world_from_view_ = glm::normalize(glm::quat_cast(glm::dmat3(camera.world_from_camera)));
  const glm::dvec3 position(camera.world_from_camera[3]);
  const glm::dvec3 forward = world_from_view_ * glm::dvec3(0, 0, -1);
  is_orthographic_ = camera.kind == scene::CameraKind::Orthographic;
  // The window does not mirror.
  aspect_ = is_orthographic_ ? std::abs(camera.half_width / camera.half_height) : camera.aspect;
  const double to_middle = bounds.is_empty() ? 0.0 : glm::dot(glm::dvec3(bounds.center()) - position, forward);
  distance_ = to_middle > distance_min ? to_middle : 5.0;
  if (is_orthographic_) {
    // The perspective picture has the height of the orthographic one at the orbit centre.
    vertical_angle_ = 0.7F;
    const double distance = std::abs(double(camera.half_height)) / std::tan(0.5 * double(vertical_angle_));
    target_ws_ = position + distance_ * forward;
    distance_ = std::clamp(distance, distance_min, distance_max);
    return;
  }
  vertical_angle_ = camera.vertical_angle;
  distance_ = std::clamp(distance_, distance_min, distance_max);
  target_ws_ = position + distance_ * forward;
}

void Navigation::look_from(Side side)
{
  const double quarter = glm::half_pi<double>();
  const auto turn = [](double angle, const glm::dvec3 &axis) { return glm::angleAxis(angle, axis); };
  switch (side) {
    case Side::Front: world_from_view_ = turn(0.0, {0, 1, 0}); break;
    case Side::Back: world_from_view_ = turn(2.0 * quarter, {0, 1, 0}); break;
    case Side::Right: world_from_view_ = turn(quarter, {0, 1, 0}); break;
    case Side::Left: world_from_view_ = turn(-quarter, {0, 1, 0}); break;
    case Side::Top: world_from_view_ = turn(-quarter, {1, 0, 0}); break;
    case Side::Bottom: world_from_view_ = turn(quarter, {1, 0, 0}); break;
  }
}

void Navigation::frame(const scene::Bounds &bounds)
{
  if (bounds.is_empty()) {
    return;
  }
  aspect_ = 0.0F;
  target_ws_ = glm::dvec3(bounds.center());
  // The sphere around the box touches the cone of view. The minimum radius is for a box that is a point.
  const double radius = std::max(double(bounds.radius()), 0.05);
  distance_ = std::clamp(1.05 * radius / std::sin(0.5 * double(vertical_angle_)), distance_min, distance_max);
}

void Navigation::orbit(glm::dvec2 angles)
{
  const glm::dquat around_up = glm::angleAxis(angles.x, glm::dvec3(0, 1, 0));
  const glm::dquat around_right = glm::angleAxis(angles.y, glm::dvec3(1, 0, 0));
  world_from_view_ = glm::normalize(around_up * world_from_view_ * around_right);
}

void Navigation::pan(glm::dvec2 fractions)
{
  const glm::dvec2 way = -2.0 * half_height() * fractions;
  target_ws_ += world_from_view_ * glm::dvec3(way, 0.0);
}

void Navigation::zoom(double factor)
{
  distance_ = std::clamp(distance_ * factor, distance_min, distance_max);
}

void Navigation::toggle_orthographic()
{
  is_orthographic_ = !is_orthographic_;
}

void Navigation::move(const glm::dvec3 &way)
{
  target_ws_ += world_from_view_ * way;
}

void Navigation::turn(glm::dvec2 angles)
{
  const glm::dvec3 to_eye(0.0, 0.0, distance_);
  const glm::dvec3 eye = target_ws_ + world_from_view_ * to_eye;
  orbit(angles);
  target_ws_ = eye - world_from_view_ * to_eye;
}

scene::PlacedCamera Navigation::camera(double extent) const
{
  scene::PlacedCamera camera;
  camera.name = "viewport";
  double distance = distance_;
  if (is_orthographic_) {
    camera.kind = scene::CameraKind::Orthographic;
    camera.half_height = float(half_height());
    camera.half_width = camera.half_height * (aspect_ > 0.0F ? aspect_ : 1.0F);
    // Move the camera back, so that no part of the scene is behind it.
    distance += 2.0 * extent;
    camera.near = 0.0F;
    camera.far = float(distance + 2.0 * extent + glm::length(target_ws_) * 1e-3 + 1.0);
  }
  else {
    camera.vertical_angle = vertical_angle_;
    camera.aspect = aspect_;
    camera.near = float(std::max(1e-3 * std::min(distance, 100.0), 1e-5));
  }
  camera.world_from_camera = glm::mat4_cast(world_from_view_);
  camera.world_from_camera[3] = glm::dvec4(target_ws_ - distance * (world_from_view_ * glm::dvec3(0, 0, -1)), 1.0);
  return camera;
}

}  // namespace gnomon::view
