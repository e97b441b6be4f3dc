// SPDX-License-Identifier: MIT
#include "render_camera.hh"

#include "gpu_error.hh"

#include <fmt/format.h>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::render_scene {

void check(const scene::PlacedCamera &camera)
{
  const auto refuse = [&](std::string_view what) { throw gpu::Error("camera '{}': its {}", camera.name, what); };
  const glm::dvec3 position_ws(camera.world_from_camera[3]);
  if (!std::isfinite(position_ws.x + position_ws.y + position_ws.z)) {
    refuse("position is not finite");
  }
  // The negated conditions are also true for NaN.
  if (camera.kind == scene::CameraKind::Perspective) {
    if (!(camera.vertical_angle > 0.0F && camera.vertical_angle <= 3.1415927F)) {
      refuse(fmt::format("vertical angle {} is not above 0 and below pi", camera.vertical_angle));
    }
    if (!(camera.near > 0.0F && camera.near <= std::numeric_limits<float>::max())) {
      refuse(fmt::format("near plane {} is not above 0", camera.near));
    }
  }
  else if (!(camera.half_width != 0.0F && camera.half_height != 0.0F && std::isfinite(camera.half_width) &&
             std::isfinite(camera.half_height))) {
    refuse(fmt::format("half size {}x{} is 0 or not finite", camera.half_width, camera.half_height));
  }
  if (!(std::isfinite(camera.near) && !std::isnan(camera.far) && camera.aspect >= 0.0F)) {
    refuse(fmt::format("near plane {}, far plane {} or aspect ratio {} is not a number that can be drawn", camera.near,
                       camera.far, camera.aspect));
  }
  if (!std::isfinite(camera.shift_x + camera.shift_y)) {
    refuse(fmt::format("shift of {} and {} is not finite", camera.shift_x, camera.shift_y));
  }
  // The limit keeps products finite: those of the projection with the slope of a ray from the edge of the aperture to
  // the middle of the plane in focus.
  constexpr float slope_max = 1e25F;
  const float reach = camera.aperture_radius / std::min(camera.aperture_ratio, 1.0F);
  const float slope = camera.focus_distance == 0.0F ? 0.0F : reach / camera.focus_distance;
  if (!(camera.aperture_radius >= 0.0F && reach <= slope_max && camera.focus_distance >= 0.0F && slope <= slope_max &&
        camera.aperture_ratio > 0.0F && std::isfinite(camera.aperture_rotation) &&
        (camera.aperture_blades == 0 || camera.aperture_blades >= 3))) {
    refuse(
        fmt::format("aperture of radius {}, ratio {}, rotation {} and {} blades, with a focus at {}, cannot be drawn",
                    camera.aperture_radius, camera.aperture_ratio, camera.aperture_rotation, camera.aperture_blades,
                    camera.focus_distance));
  }
}

/** A pinhole where the aperture is closed or the camera is orthographic. */
static draw::Lens lens_of(const scene::PlacedCamera &camera)
{
  if (camera.aperture_radius == 0.0F || camera.kind != scene::CameraKind::Perspective) {
    return {};
  }
  return {
      .radius = camera.aperture_radius,
      .focus_distance = camera.focus_distance > 0.0F ? camera.focus_distance : std::numeric_limits<float>::infinity(),
      .blades = camera.aperture_blades,
      .rotation = camera.aperture_rotation,
      .ratio = camera.aperture_ratio};
}

draw::View view_of(const scene::PlacedCamera &camera, glm::ivec2 size_px, const glm::dvec3 &origin_ws)
{
  check(camera);
  const bool is_perspective = camera.kind == scene::CameraKind::Perspective;
  const float image_aspect = float(size_px.x) / float(size_px.y);
  // The float nearest to π exceeds π, so the tangent of its half would be negative.
  constexpr float angle_max = 3.1415F;
  float half_height =
      is_perspective ? std::tan(0.5F * std::min(camera.vertical_angle, angle_max)) : std::abs(camera.half_height);
  const float frame_aspect = !is_perspective        ? std::abs(camera.half_width / camera.half_height)
                             : camera.aspect > 0.0F ? camera.aspect
                                                    : image_aspect;
  // The middle of the frame, which may be narrower than the image, at distance 1 where perspective.
  const glm::vec2 shift = 2.0F * half_height * glm::vec2(frame_aspect * camera.shift_x, camera.shift_y);
  if (image_aspect < frame_aspect) {
    half_height *= frame_aspect / image_aspect;
  }
  const float half_width = half_height * image_aspect;
  if (!(half_width > 0.0F && half_height > 0.0F)) {
    throw gpu::Error("camera '{}': its frame of {}x{} is too small", camera.name, half_width, half_height);
  }
  constexpr float infinite = std::numeric_limits<float>::infinity();
  const float far = camera.far > camera.near ? camera.far : infinite;
  glm::mat4 clip_from_view;
  if (is_perspective) {
    clip_from_view = draw::perspective(half_width, half_height, camera.near, far);
  }
  else {
    // An orthographic projection of infinite depth has no finite matrix. Use a depth of a million half widths instead.
    const float depth_max = std::max(camera.near + 1e6F * half_width, std::nextafter(camera.near, infinite));
    clip_from_view =
        draw::orthographic(std::copysign(half_width, camera.half_width), std::copysign(half_height, camera.half_height),
                           camera.near, std::isinf(far) ? depth_max : far);
  }
  for (int axis = 0; axis < 2; axis++) {
    const float shift_clip = shift[axis] * clip_from_view[axis][axis];
    clip_from_view[is_perspective ? 2 : 3][axis] = is_perspective ? shift_clip : -shift_clip;
  }
  glm::dmat4 world_from_camera = camera.world_from_camera;
  world_from_camera[3] -= glm::dvec4(origin_ws, 0.0);
  return {glm::mat4(glm::inverse(world_from_camera)), clip_from_view, lens_of(camera)};
}

}  // namespace gnomon::render_scene
