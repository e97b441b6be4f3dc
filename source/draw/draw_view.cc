// SPDX-License-Identifier: MIT
#include "draw_view.hh"

#include "gpu_error.hh"

#include "draw_view_shared.h"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gnomon::draw {

ObjectSet::ObjectSet(std::vector<std::uint8_t> flags)
{
  for (std::uint8_t &flag : flags) {
    flag = flag != 0 ? 1 : 0;
  }
  while (!flags.empty() && flags.back() == 0) {
    flags.pop_back();
  }
  if (!flags.empty()) {
    flags_ = std::make_shared<const std::vector<std::uint8_t>>(std::move(flags));
  }
}

bool ObjectSet::operator==(const ObjectSet &other) const
{
  return flags_ == other.flags_ || (flags_ && other.flags_ && *flags_ == *other.flags_);
}

View View::with_hidden(ObjectSet hidden) const
{
  View view = *this;
  view.hidden_ = std::move(hidden);
  return view;
}

View View::with_clip_planes(std::vector<glm::vec4> planes) const
{
  if (planes.size() > clip_plane_max) {
    throw gpu::Error("view: {} clip planes are more than the {} that it can have", planes.size(), clip_plane_max);
  }
  for (std::size_t i = 0; i < planes.size(); i++) {
    const glm::vec4 &plane = planes[i];
    if (!std::isfinite(plane.x) || !std::isfinite(plane.y) || !std::isfinite(plane.z) || !std::isfinite(plane.w)) {
      throw gpu::Error("view: clip plane {} is not finite", i);
    }
  }
  View view = *this;
  view.clip_planes_ = std::move(planes);
  return view;
}

View View::with_matrices(const glm::mat4 &view_from_world, const glm::mat4 &clip_from_view, const Lens &lens) const
{
  View view(view_from_world, clip_from_view, lens);
  view.hidden_ = hidden_;
  view.clip_planes_ = clip_planes_;
  return view;
}

void set_clip_planes(shared::ViewData &data, const View &view, const gpu::Rectangle &picture)
{
  if (view.clip_planes().empty()) {
    return;
  }
  // From a fragment's (x, y, z, 1) to its normalized device coordinates.
  glm::dmat4 ndc_from_window(1.0);
  for (int axis = 0; axis < 2; axis++) {
    ndc_from_window[axis][axis] = 2.0 / picture.size_px[axis];
    ndc_from_window[3][axis] = -1.0 - 2.0 * picture.origin_px[axis] / picture.size_px[axis];
  }
  const glm::dmat4 clip_from_world = glm::dmat4(view.clip_from_view()) * glm::dmat4(view.view_from_world());
  const glm::dmat4 window_from_plane = glm::transpose(glm::inverse(clip_from_world) * ndc_from_window);
  // The other planes stay (0, 0, 0, 0), behind which nothing is.
  for (std::size_t i = 0; i < view.clip_planes().size(); i++) {
    const glm::dvec4 plane = window_from_plane * glm::dvec4(view.clip_planes()[i]);
    const double most = std::max({std::abs(plane.x), std::abs(plane.y), std::abs(plane.z), std::abs(plane.w)});
    data.clip_planes[i] = most > 0.0 && std::isfinite(most) ? glm::vec4(plane / most) : glm::vec4(0.0F);
  }
}

View::View(const glm::mat4 &view_from_world, const glm::mat4 &clip_from_view, const Lens &lens)
    : view_from_world_(view_from_world),
      clip_from_view_(clip_from_view),
      clip_from_world_(clip_from_view * view_from_world),
      lens_(lens)
{
  const glm::mat4 rows = glm::transpose(clip_from_world_);
  // Gribb and Hartmann 2001, for reversed z in [0, w]: a point is inside the near plane if z <= w, and inside the far
  // plane if z >= 0.
  frustum_planes_ws_ = {rows[3] + rows[0], rows[3] - rows[0], rows[3] + rows[1],
                        rows[3] - rows[1], rows[3] - rows[2], rows[2]};
  for (glm::vec4 &plane : frustum_planes_ws_) {
    const float length = glm::length(glm::vec3(plane));
    plane = length > 0.0F ? plane / length : glm::vec4(0.0F, 0.0F, 0.0F, 1.0F);
  }
}

float culling_reach(const CullingVolume &volume)
{
  if (volume.radius < 0.0F) {
    return std::numeric_limits<float>::infinity();
  }
  // Far from the origin, rounding errors of the products exceed the radius of small spheres.
  const glm::vec3 &center = volume.center_ws;
  return volume.radius + 1e-6F * (std::abs(center.x) + std::abs(center.y) + std::abs(center.z));
}

CullingPlanes View::culling_planes() const
{
  CullingPlanes planes = frustum_planes_ws_;
  for (glm::vec4 &plane : planes) {
    plane.w += 1e-6F * std::abs(plane.w);
  }
  return planes;
}

bool touches(const CullingPlanes &planes, const CullingVolume &volume)
{
  const float lowest = -culling_reach(volume);
  return std::ranges::none_of(
      planes, [&](const glm::vec4 &plane) { return glm::dot(glm::vec3(plane), volume.center_ws) + plane.w < lowest; });
}

bool View::touches(const CullingVolume &volume) const
{
  return draw::touches(culling_planes(), volume);
}

glm::mat4 perspective(float half_width, float half_height, float near, float far)
{
  GNOMON_ASSERT(half_width > 0.0F && half_height > 0.0F && near > 0.0F && far > near,
                "half size {}x{}, near {}, far {}", half_width, half_height, near, far);
  glm::mat4 clip_from_view(0.0F);
  clip_from_view[0][0] = 1.0F / half_width;
  clip_from_view[1][1] = 1.0F / half_height;
  clip_from_view[2][3] = -1.0F;
  // z_clip = a · z_view + b, where z_clip / w is 1 at near and 0 at far. For far → ∞: a → 0 and b → near.
  const double n = near;
  const double f = far;
  clip_from_view[2][2] = std::isinf(far) ? 0.0F : float(n / (f - n));
  clip_from_view[3][2] = std::isinf(far) ? near : float(n * f / (f - n));
  return clip_from_view;
}

glm::mat4 orthographic(float half_width, float half_height, float near, float far)
{
  GNOMON_ASSERT(half_width != 0.0F && half_height != 0.0F && far > near, "half size {}x{}, near {}, far {}", half_width,
                half_height, near, far);
  glm::mat4 clip_from_view(1.0F);
  clip_from_view[0][0] = 1.0F / half_width;
  clip_from_view[1][1] = 1.0F / half_height;
  const double depth = double(far) - double(near);
  clip_from_view[2][2] = float(1.0 / depth);
  clip_from_view[3][2] = float(double(far) / depth);
  return clip_from_view;
}

}  // namespace gnomon::draw
