// SPDX-License-Identifier: MIT
#pragma once

#include "overlay.hh"

#include <glm/vec3.hpp>

#include <span>
#include <vector>

namespace gnomon::view {

/** Collects lines of one style. */
struct LineBrush {
  std::vector<overlay::Line> &lines;
  glm::vec4 color{1.0F};
  float width_px = 1.5F;
  bool is_on_top = false;

  void line(const glm::dvec3 &from_ws, const glm::dvec3 &to_ws) const
  {
    lines.push_back({from_ws, to_ws, color, width_px, is_on_top});
  }
  /** Add lines through all points, and back to the first if \a is_closed. */
  void path(std::span<const glm::dvec3> points_ws, bool is_closed) const;
};

/** Points of an ellipse with these half axes, from \a x_ws towards \a y_ws. \a part: fraction of the full turn. */
[[nodiscard]] std::vector<glm::dvec3> ellipse(const glm::dvec3 &center_ws, const glm::dvec3 &x_ws,
                                              const glm::dvec3 &y_ws, int point_count = 48, double part = 1.0);

}  // namespace gnomon::view
