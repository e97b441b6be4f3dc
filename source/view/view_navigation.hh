// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace gnomon::view {

/** Directions to look from. Y is up, and a camera that looks from the front looks along -Z. */
enum class Side { Front, Back, Left, Right, Top, Bottom };

/** The camera of a viewport: it looks at a point from a distance, and turns around it. Radians, metres. */
class Navigation {
 public:
  bool operator==(const Navigation &) const = default;

  /** Look as \a camera does, at what is in the middle of \a bounds. */
  void look_through(const scene::PlacedCamera &camera, const scene::Bounds &bounds);
  void look_from(Side side);
  /** Move so that all of \a bounds is seen, in the same direction. An empty box changes nothing. */
  void frame(const scene::Bounds &bounds);
  /** Turn around the point: x around the world's Y axis, y around the view's horizontal axis. */
  void orbit(glm::dvec2 angles);
  /** Move sideways, as fractions of the picture's height, right and up: the scene moves with the pointer. */
  void pan(glm::dvec2 fractions);
  /** Multiply the distance. \pre factor > 0 */
  void zoom(double factor);
  void toggle_orthographic();
  /** Move the eye, and the point with it: right, up and back, metres. */
  void move(const glm::dvec3 &way);
  /** Turn the head, as orbit, but around the eye. */
  void turn(glm::dvec2 angles);

  /** The camera that \a extent, the radius of the scene, is seen with. */
  [[nodiscard]] scene::PlacedCamera camera(double extent) const;
  /** From the eye to the point, metres. */
  [[nodiscard]] double distance() const
  {
    return distance_;
  }
  /** World space, metres: the point that the camera turns around. */
  [[nodiscard]] const glm::dvec3 &target_ws() const
  {
    return target_ws_;
  }

 private:
  /** Half the picture's height at the point. */
  [[nodiscard]] double half_height() const;

  glm::dvec3 target_ws_{0.0};
  double distance_ = 5.0;
  glm::dquat world_from_view_{1.0, 0.0, 0.0, 0.0};
  bool is_orthographic_ = false;
  /** Of the lens, both for pictures in perspective and, by half_height, for parallel ones. */
  float vertical_angle_ = 0.7F;
  /** Width / height of the lens's frame; 0: the picture's. */
  float aspect_ = 0.0F;
};

}  // namespace gnomon::view
