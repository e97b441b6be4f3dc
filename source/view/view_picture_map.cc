// SPDX-License-Identifier: MIT
#include "view_picture_map.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::view {

PictureMap::PictureMap(const draw::View &view, const glm::dvec3 &origin_ws, glm::ivec2 size_px)
    : view_from_world_(glm::translate(glm::dmat4(view.view_from_world()), -origin_ws)),
      clip_from_view_(view.clip_from_view()),
      size_px_(size_px)
{
}

std::optional<glm::dvec2> PictureMap::pixel_of(const glm::dvec3 &position_ws) const
{
  const glm::dvec4 clip = clip_from_view_ * (view_from_world_ * glm::dvec4(position_ws, 1.0));
  // Depth is reversed: in front of the near plane, it is above 1.
  if (!(clip.w > 0.0) || clip.z > clip.w) {
    return std::nullopt;
  }
  return (0.5 + 0.5 * glm::dvec2(clip.x, -clip.y) / clip.w) * size_px_;
}

Ray PictureMap::ray_through(const glm::dvec2 &pixel) const
{
  const glm::dvec2 ndc = glm::dvec2(2.0, -2.0) * (pixel / size_px_ - 0.5);
  const glm::dmat4 world_from_clip = glm::inverse(clip_from_view_ * view_from_world_);
  // Reversed depth: 1 at the near plane.
  const glm::dvec4 near = world_from_clip * glm::dvec4(ndc, 1.0, 1.0);
  const glm::dvec4 beyond = world_from_clip * glm::dvec4(ndc, 0.5, 1.0);
  const glm::dvec3 origin_ws = glm::dvec3(near) / near.w;
  return {origin_ws, glm::normalize(glm::dvec3(beyond) / beyond.w - origin_ws)};
}

double PictureMap::metres_per_pixel(const glm::dvec3 &position_ws) const
{
  const double distance = is_perspective() ? -(view_from_world_ * glm::dvec4(position_ws, 1.0)).z : 1.0;
  return 2.0 * std::max(distance, 1e-6) / (std::abs(clip_from_view_[1][1]) * size_px_.y);
}

glm::dvec3 PictureMap::towards_eye(const glm::dvec3 &position_ws) const
{
  const glm::dvec3 position_vs(view_from_world_ * glm::dvec4(position_ws, 1.0));
  if (!is_perspective() || glm::length(position_vs) < 1e-9) {
    return axis_ws(2);
  }
  return glm::transpose(glm::dmat3(view_from_world_)) * -glm::normalize(position_vs);
}

}  // namespace gnomon::view
