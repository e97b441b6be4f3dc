// SPDX-License-Identifier: MIT
#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>

namespace gnomon::draw {

/** Sphere around what a call draws: the call is left out where a view does not touch it. World space, metres. */
struct CullingVolume {
  glm::vec3 center_ws{0.0F};
  /** Negative: never culled. */
  float radius = -1.0F;
};

/** Where a pass is seen from. */
class View {
 public:
  View() : View(glm::mat4(1.0F), glm::mat4(1.0F)) {}
  /** Both finite. \a clip_from_view maps the near plane to z = w and the far one to 0 (reversed depth). */
  View(const glm::mat4 &view_from_world, const glm::mat4 &clip_from_view);

  [[nodiscard]] const glm::mat4 &view_from_world() const
  {
    return view_from_world_;
  }
  [[nodiscard]] const glm::mat4 &clip_from_view() const
  {
    return clip_from_view_;
  }
  [[nodiscard]] const glm::mat4 &clip_from_world() const
  {
    return clip_from_world_;
  }
  [[nodiscard]] bool is_perspective() const
  {
    return clip_from_view_[3][3] == 0.0F;
  }
  /**
   * Left, right, bottom, top, near, far: a point is inside where dot(plane, (point, 1)) >= 0. The normals
   * are unit vectors. An infinite far plane is (0, 0, 0, 1): everything is inside.
   */
  [[nodiscard]] const std::array<glm::vec4, 6> &frustum_planes_ws() const
  {
    return frustum_planes_ws_;
  }
  /** Whether any of the sphere may be in the frustum: no false no, rare false yes near the edges. */
  [[nodiscard]] bool touches(const CullingVolume &volume) const;
  bool operator==(const View &) const = default;

 private:
  glm::mat4 view_from_world_;
  glm::mat4 clip_from_view_;
  glm::mat4 clip_from_world_;
  std::array<glm::vec4, 6> frustum_planes_ws_;
};

/**
 * Camera to reversed clip space, z / w in [0, 1], near at 1. \a half_width and \a half_height are
 * measured on the plane at distance 1. \pre all above 0; far above near, or infinite.
 */
[[nodiscard]] glm::mat4 perspective(float half_width, float half_height, float near, float far);

/** The same for parallel projection: near at 1, far at 0. \pre half sizes above 0, far above near. */
[[nodiscard]] glm::mat4 orthographic(float half_width, float half_height, float near, float far);

}  // namespace gnomon::draw
