// SPDX-License-Identifier: MIT
#include "view_gizmo.hh"

#include "view_lines.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace gnomon::view {

namespace {

constexpr std::array all_axes = {TransformAxis::X, TransformAxis::Y, TransformAxis::Z, TransformAxis::All};
/** Indexed by TransformAxis. */
constexpr std::array<glm::vec4, 4> colors = {glm::vec4(0.85F, 0.85F, 0.85F, 1.0F), glm::vec4(0.95F, 0.25F, 0.3F, 1.0F),
                                             glm::vec4(0.5F, 0.8F, 0.15F, 1.0F), glm::vec4(0.25F, 0.55F, 1.0F, 1.0F)};
constexpr glm::vec4 pointed_color(1.0F, 0.9F, 0.35F, 1.0F);

/** Lengths on the screen, pixels. */
constexpr double axis_px = 80.0;
constexpr double start_px = 16.0;
constexpr double tip_px = 14.0;
constexpr double tip_width_px = 4.5;
constexpr double all_px = 12.0;
constexpr double sight_ring_px = 92.0;
constexpr double reach_px = 7.0;

using Path = std::vector<glm::dvec3>;

/** Two unit vectors across \a axis. */
std::array<glm::dvec3, 2> across(const glm::dvec3 &axis)
{
  const glm::dvec3 least = std::abs(axis.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 first = glm::normalize(glm::cross(axis, least));
  return {first, glm::cross(axis, first)};
}

Path screen_circle(const PictureMap &map, const glm::dvec3 &position_ws, double radius_px)
{
  // The circle is perpendicular to the line of sight to the node, so that it looks round also away from the middle of
  // the picture.
  const double radius = radius_px * map.metres_per_pixel(position_ws);
  const auto [x, y] = across(map.towards_eye(position_ws));
  Path circle = ellipse(position_ws, radius * x, radius * y);
  circle.push_back(circle.front());
  return circle;
}

/** The half of the circle around \a axis that is nearer to the eye; the whole circle if \a axis points to the eye. */
Path ring(const PictureMap &map, const glm::dvec3 &position_ws, const glm::dvec3 &axis)
{
  const double radius = axis_px * map.metres_per_pixel(position_ws);
  const glm::dvec3 eye = map.towards_eye(position_ws);
  if (std::abs(glm::dot(axis, eye)) > along_sight) {
    const auto [x, y] = across(axis);
    Path circle = ellipse(position_ws, radius * x, radius * y);
    circle.push_back(circle.front());
    return circle;
  }
  const glm::dvec3 side = glm::normalize(glm::cross(eye, axis));
  const glm::dvec3 front = glm::cross(axis, side);
  return ellipse(position_ws, radius * side, radius * front, 32, 0.5);
}

/** A handle's line and its tip: an arrow head for moving, a square for scaling. */
std::vector<Path> arrow(const PictureMap &map, const glm::dvec3 &position_ws, const glm::dvec3 &axis,
                        TransformKind kind)
{
  const double pixel = map.metres_per_pixel(position_ws);
  const auto at = [&](double along_px) { return position_ws + along_px * pixel * axis; };
  // The tip lies in the picture's plane, so that its width is the same from every direction.
  const glm::dvec3 side = tip_width_px * pixel * glm::normalize(glm::cross(axis, map.towards_eye(position_ws)));
  if (kind == TransformKind::Move) {
    const glm::dvec3 back = at(axis_px - tip_px);
    return {{at(start_px), at(axis_px)}, {back + side, at(axis_px), back - side, back + side}};
  }
  const glm::dvec3 near = at(axis_px - 2.0 * tip_width_px);
  const glm::dvec3 far = at(axis_px);
  return {{at(start_px), near}, {near + side, far + side, far - side, near - side, near + side}};
}

std::vector<Path> paths_of(const Gizmo &gizmo, const PictureMap &map, TransformAxis axis)
{
  const glm::dvec3 position_ws(gizmo.world_from_node[3]);
  if (axis == TransformAxis::All) {
    return {screen_circle(map, position_ws, gizmo.kind == TransformKind::Rotate ? sight_ring_px : all_px)};
  }
  const glm::dvec3 direction = axis_ws(gizmo.world_from_node, axis, gizmo.orientation);
  if (gizmo.kind == TransformKind::Rotate) {
    return {ring(map, position_ws, direction)};
  }
  if (std::abs(glm::dot(direction, map.towards_eye(position_ws))) > along_sight) {
    return {};
  }
  return arrow(map, position_ws, direction, gizmo.kind);
}

double distance_to_segment(const glm::dvec2 &point, const glm::dvec2 &from, const glm::dvec2 &to)
{
  const glm::dvec2 way = to - from;
  const double length_squared = glm::dot(way, way);
  const double along = length_squared > 0.0 ? std::clamp(glm::dot(point - from, way) / length_squared, 0.0, 1.0) : 0.0;
  return glm::distance(point, from + along * way);
}

}  // namespace

std::vector<overlay::Line> Gizmo::lines(const PictureMap &map, std::optional<TransformAxis> pointed) const
{
  std::vector<overlay::Line> lines;
  for (const TransformAxis axis : all_axes) {
    const LineBrush brush{lines, pointed == axis ? pointed_color : colors[std::size_t(axis)], 2.5F, true};
    for (const Path &path : paths_of(*this, map, axis)) {
      brush.path(path, false);
    }
  }
  return lines;
}

std::optional<TransformAxis> Gizmo::handle_at(const PictureMap &map, const glm::dvec2 &pixel) const
{
  std::optional<TransformAxis> nearest;
  double distance = reach_px;
  for (const TransformAxis axis : all_axes) {
    for (const Path &path : paths_of(*this, map, axis)) {
      for (std::size_t i = 1; i < path.size(); i++) {
        const std::optional<glm::dvec2> from = map.pixel_of(path[i - 1]);
        const std::optional<glm::dvec2> to = map.pixel_of(path[i]);
        const double reach = from && to ? distance_to_segment(pixel, *from, *to) : distance;
        if (reach < distance) {
          distance = reach;
          nearest = axis;
        }
      }
    }
  }
  return nearest;
}

std::vector<overlay::Line> axis_lines(const TransformOperation &operation, const PictureMap &map)
{
  std::vector<overlay::Line> lines;
  const Transform &transform = operation.transform();
  if (transform.axis != TransformAxis::All) {
    const glm::dvec3 position_ws(operation.start_ws()[3]);
    // The line reaches beyond the edges of the picture.
    const glm::dvec3 way =
        1e4 * map.metres_per_pixel(position_ws) * axis_ws(operation.start_ws(), transform.axis, transform.orientation);
    LineBrush{lines, colors[std::size_t(transform.axis)], 1.5F, true}.line(position_ws - way, position_ws + way);
  }
  return lines;
}

}  // namespace gnomon::view
