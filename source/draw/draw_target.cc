// SPDX-License-Identifier: MIT
#include "draw_target.hh"

#include <algorithm>
#include <cmath>

namespace gnomon::draw {

namespace {

glm::ivec2 size_of(const Target &target)
{
  const auto *const *own = std::get_if<const gpu::Framebuffer *>(&target.framebuffer);
  return own ? (*own)->size_px() : std::get<gpu::HostFramebuffer>(target.framebuffer).size_px;
}

/** Has the sign of the derivative of the host's z / w by the view's z. 0: z / w does not depend on the view's z. */
double depth_slope(const HostDepth &host)
{
  const glm::dmat4 &clip = host.clip_from_view;
  return clip[2][2] * clip[3][3] - clip[3][2] * clip[2][3];
}

}  // namespace

glm::ivec2 size_in(const Target &target, glm::ivec2 size_px)
{
  return target.size_px == glm::ivec2(0) ? size_px : target.size_px;
}

void check(const Target &target, glm::ivec2 size_px)
{
  if (!target) {
    return;
  }
  if (const auto *const *own = std::get_if<const gpu::Framebuffer *>(&target.framebuffer); own && !**own) {
    throw gpu::Error("target: the framebuffer is empty: it was destroyed, or the packet that creates it was lost");
  }
  const glm::ivec2 first = target.origin_px;
  const glm::ivec2 room = size_of(target) - first;
  const glm::ivec2 size = size_in(target, size_px);
  if (first.x < 0 || first.y < 0 || size.x < 1 || size.y < 1 || size.x > room.x || size.y > room.y) {
    throw gpu::Error("target: a picture of {}x{} px at {},{} does not fit into its {}x{} px", size.x, size.y, first.x,
                     first.y, size_of(target).x, size_of(target).y);
  }
  if (!(std::abs(target.exposure) <= exposure_max)) {
    throw gpu::Error("target: exposure {} is not in [{}, {}]", target.exposure, -exposure_max, exposure_max);
  }
  if (target.depth) {
    const glm::dvec2 range = target.depth->range;
    if (!(range.x >= 0.0 && range.x <= 1.0 && range.y >= 0.0 && range.y <= 1.0) || range.x == range.y) {
      throw gpu::Error("target: depth range {} to {} is not within [0, 1], or empty", range.x, range.y);
    }
    const double slope = depth_slope(*target.depth);
    if (!std::isfinite(slope) || slope == 0.0) {
      throw gpu::Error("target: the depth of the host's projection does not depend on the distance");
    }
  }
}

void begin_pass(gpu::CommandList &list, std::string_view name, const Target &target, glm::ivec2 size_px,
                const gpu::Rectangle &region, gpu::PassActions actions)
{
  const glm::ivec2 size = size_in(target, size_px);
  actions.viewport = {target.origin_px, size};
  actions.scissor = size == size_px ? gpu::Rectangle{target.origin_px + region.origin_px, region.size_px}
                                    : gpu::Rectangle{target.origin_px, size};
  actions.is_srgb_encoded = target.encoding == Encoding::SrgbFormat && target.view_transform != ViewTransform::Raw;
  if (const auto *const *own = std::get_if<const gpu::Framebuffer *>(&target.framebuffer)) {
    list.begin_pass(name, **own, actions);
  }
  else {
    list.begin_pass(name, std::get<gpu::HostFramebuffer>(target.framebuffer), actions);
  }
}

DepthMap depth_map(const glm::mat4 &clip_from_view, const HostDepth &host)
{
  // The view's z of a depth d is (from[3][3] d - from[3][2]) / (from[2][2] - from[2][3] d). row() inserts this into a
  // row of the host's projection and multiplies by the denominator.
  const glm::dmat4 from(clip_from_view);
  const glm::dmat4 &to = host.clip_from_view;
  const auto row = [&](int i) {
    return glm::dvec2(to[2][i] * from[3][3] - to[3][i] * from[2][3], to[3][i] * from[2][2] - to[2][i] * from[3][2]);
  };
  const glm::dvec2 z = row(2);
  const glm::dvec2 w = row(3);
  const double low = host.is_zero_to_one ? 0.0 : -1.0;
  const double scale = (host.range.y - host.range.x) / (1.0 - low);
  const double offset = host.range.x - scale * low;
  const glm::dvec2 stored = scale * z + offset * w;
  // The view's z decreases with the distance, so a negative slope means that the host's z / w increases with it.
  const bool is_far_upper = depth_slope(host) < 0.0;
  const double far = is_far_upper ? host.range.y : host.range.x;
  const double near = is_far_upper ? host.range.x : host.range.y;
  // Numerator and denominator may be scaled by a common factor. Scale the largest number to 1.
  const double largest = std::max({std::abs(stored.x), std::abs(stored.y), std::abs(w.x), std::abs(w.y)});
  return {glm::vec4(glm::dvec4(stored, w) / largest), float(far), near < far};
}

TargetTexture::TargetTexture(gpu::Device &device, std::string name, gpu::Format format, glm::ivec2 size_px)
    : texture_(
          device.create_texture({.name = std::move(name), .format = format, .width = size_px.x, .height = size_px.y})),
      framebuffer_(device.create_framebuffer({.name = texture_.desc().name, .colors = {{&texture_}}, .depth = {}}))
{
}

}  // namespace gnomon::draw
