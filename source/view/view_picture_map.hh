// SPDX-License-Identifier: MIT
#pragma once

#include "draw_view.hh"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>

#include <optional>

namespace gnomon::view {

struct Ray {
  glm::dvec3 origin_ws{0.0};
  /** Unit vector. */
  glm::dvec3 direction_ws{0.0, 0.0, -1.0};
};

/** Mapping between world space and the pixels of a picture, counted from its upper left corner. */
class PictureMap {
 public:
  PictureMap() = default;
  /** \a view: relative to \a origin_ws, as render_scene::view_of gives it. */
  PictureMap(const draw::View &view, const glm::dvec3 &origin_ws, glm::ivec2 size_px);

  /** Empty: the point is beside or behind the eye. The pixel may be outside of the picture. */
  [[nodiscard]] std::optional<glm::dvec2> pixel_of(const glm::dvec3 &position_ws) const;
  /** The ray through \a pixel, from the near plane on. */
  [[nodiscard]] Ray ray_through(const glm::dvec2 &pixel) const;
  /** Size of a pixel at the distance of a visible point. */
  [[nodiscard]] double metres_per_pixel(const glm::dvec3 &position_ws) const;
  /** Unit vector. */
  [[nodiscard]] glm::dvec3 towards_eye(const glm::dvec3 &position_ws) const;
  /** Unit vectors of the camera's axes. \a axis: 0 right, 1 up, 2 back. */
  [[nodiscard]] glm::dvec3 axis_ws(int axis) const
  {
    return {view_from_world_[0][axis], view_from_world_[1][axis], view_from_world_[2][axis]};
  }

 private:
  [[nodiscard]] bool is_perspective() const
  {
    return clip_from_view_[3][3] == 0.0;
  }

  glm::dmat4 view_from_world_{1.0};
  glm::dmat4 clip_from_view_{1.0};
  glm::dvec2 size_px_{1.0};
};

}  // namespace gnomon::view
