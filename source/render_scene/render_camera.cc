// SPDX-License-Identifier: MIT
#include "render_camera.hh"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::render_scene {

draw::View view_of(const scene::PlacedCamera &camera, glm::ivec2 size_px, const glm::dvec3 &origin_ws)
{
  const bool is_perspective = camera.kind == scene::CameraKind::Perspective;
  const float image_aspect = float(size_px.x) / float(size_px.y);
  // The float nearest to π exceeds π, so the tangent of its half would be negative.
  constexpr float angle_max = 3.1415F;
  float half_height = is_perspective ? std::tan(0.5F * std::min(camera.vertical_angle, angle_max)) : camera.half_height;
  const float frame_aspect = !is_perspective        ? camera.half_width / camera.half_height
                             : camera.aspect > 0.0F ? camera.aspect
                                                    : image_aspect;
  if (image_aspect < frame_aspect) {
    half_height *= frame_aspect / image_aspect;
  }
  const float half_width = half_height * image_aspect;
  constexpr float infinite = std::numeric_limits<float>::infinity();
  const float far = camera.far > camera.near ? camera.far : infinite;
  glm::mat4 clip_from_view;
  if (is_perspective) {
    clip_from_view = draw::perspective(half_width, half_height, camera.near, far);
  }
  else {
    // An orthographic projection of infinite depth has no finite matrix. Use a depth of a million half widths instead.
    const float depth_max = std::max(camera.near + 1e6F * half_width, std::nextafter(camera.near, infinite));
    clip_from_view = draw::orthographic(half_width, half_height, camera.near, std::isinf(far) ? depth_max : far);
  }
  glm::dmat4 world_from_camera = camera.world_from_camera;
  world_from_camera[3] -= glm::dvec4(origin_ws, 0.0);
  return {glm::mat4(glm::inverse(world_from_camera)), clip_from_view};
}

}  // namespace gnomon::render_scene
