// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace gnomon::view {

/** Standard views, named by the side that the camera is on. Y is up; from the front, the camera looks along -Z. */
enum class Side { Front, Back, Left, Right, Top, Bottom };

/** The camera of a viewport, which orbits around a point at a distance. Radians, metres. */
class Navigation {
 public:
  bool operator==(const Navigation &) const = default;

  /** Take over position and lens of \a camera; set the orbit centre at the distance of the middle of \a bounds. */
  void look_through(const scene::PlacedCamera &camera, const scene::Bounds &bounds);
  void look_from(Side side);
  /** Move the camera so that \a bounds fits into the picture; the direction stays. An empty box changes nothing. */
  void frame(const scene::Bounds &bounds);
  /** Orbit around the point: x around the world's Y axis, y around the view's horizontal axis. */
  void orbit(glm::dvec2 angles);
  /** Move the scene right and up by fractions of the picture's height, so that it follows the pointer. */
  void pan(glm::dvec2 fractions);
  /** Multiply the distance. \pre factor > 0 */
  void zoom(double factor);
  void toggle_orthographic();
  /** Move the eye and the orbit centre. \a way: right, up and back, metres. */
  void move(const glm::dvec3 &way);
  /** Rotate around the eye, with the angles of orbit. */
  void turn(glm::dvec2 angles);

  /** The camera of the picture. \a extent: radius of the scene, metres, for the depth range. */
  [[nodiscard]] scene::PlacedCamera camera(double extent) const;
  /** Distance from the eye to the orbit centre, metres. */
  [[nodiscard]] double distance() const
  {
    return distance_;
  }
  /** Orbit centre, world space, metres. */
  [[nodiscard]] const glm::dvec3 &target_ws() const
  {
    return target_ws_;
  }

 private:
  /** Half the picture's height at the orbit centre, metres. */
  [[nodiscard]] double half_height() const;

  glm::dvec3 target_ws_{0.0};
  double distance_ = 5.0;
  glm::dquat world_from_view_{1.0, 0.0, 0.0, 0.0};
  bool is_orthographic_ = false;
  /** The lens's angle, radians, for pictures in perspective and, by half_height, for parallel ones. */
  float vertical_angle_ = 0.7F;
  /** Width / height of the camera's frame. 0: that of the picture. */
  float aspect_ = 0.0F;
};

}  // namespace gnomon::view
