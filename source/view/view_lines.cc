// SPDX-License-Identifier: MIT
#include "view_lines.hh"

#include <cmath>
#include <numbers>

namespace gnomon::view {

void LineBrush::path(std::span<const glm::dvec3> points_ws, bool is_closed) const
{
  for (std::size_t i = 1; i < points_ws.size(); i++) {
    line(points_ws[i - 1], points_ws[i]);
  }
  if (is_closed && points_ws.size() > 2) {
    line(points_ws.back(), points_ws.front());
  }
}

std::vector<glm::dvec3> ellipse(const glm::dvec3 &center_ws, const glm::dvec3 &x_ws, const glm::dvec3 &y_ws,
                                int point_count, double part)
{
  std::vector<glm::dvec3> points;
  for (int i = 0; i < point_count; i++) {
    // An arc includes its end point; a full ellipse ends one step before its first point.
    const double turn = part * i / (part < 1.0 ? point_count - 1 : point_count);
    const double angle = 2.0 * std::numbers::pi * turn;
    points.push_back(center_ws + std::cos(angle) * x_ws + std::sin(angle) * y_ws);
  }
  return points;
}

}  // namespace gnomon::view
