// SPDX-License-Identifier: MIT
#include "overlay.hh"
#include "overlay_programs.hh"

#include "overlay_line_shared.h"

#include <algorithm>
#include <cmath>

namespace gnomon::overlay {

using gpu::State;

namespace {

/** Squares of larger coordinates are infinite in a float. */
bool is_drawable(const glm::dvec3 &position)
{
  constexpr double limit = 1e18;
  return std::abs(position.x) < limit && std::abs(position.y) < limit && std::abs(position.z) < limit;
}

bool is_finite(const glm::vec4 &color)
{
  return std::isfinite(color.r) && std::isfinite(color.g) && std::isfinite(color.b) && std::isfinite(color.a);
}

void check(std::span<const Line> lines)
{
  const auto wrong = std::ranges::find_if(lines, [](const Line &line) {
    return !is_drawable(line.from_ws) || !is_drawable(line.to_ws) || !is_finite(line.color) ||
           !(line.width_px > 0.0F && line.width_px < 1e4F);
  });
  if (wrong != lines.end()) {
    throw gpu::Error(
        "overlay: line {} from {}, {}, {} to {}, {}, {}, {} px wide, is not finite, is beyond 1e18 m or has no width",
        wrong - lines.begin(), wrong->from_ws.x, wrong->from_ws.y, wrong->from_ws.z, wrong->to_ws.x, wrong->to_ws.y,
        wrong->to_ws.z, wrong->width_px);
  }
}

}  // namespace

bool Overlay::update_hiding(const draw::View &view, glm::ivec2 size_px)
{
  gpu::Device &device = scene_.device();
  const ObjectsKey key{
      view, scene_.origin_ws(), size_px, scene_.scene().revision(), scene_.content_revision(), device.loss_count()};
  if (key != hiding_key_) {
    hiding_key_ = {};
    gpu::CommandList list;
    const auto is_any = [](draw::ObjectIndex /*object*/) { return true; };
    has_hiding_ = record_objects(view, size_px, is_any, hiding_, list);
    if (has_hiding_) {
      device.submit(list);
    }
    hiding_key_ = key;
  }
  return has_hiding_;
}

void Overlay::upload(std::span<const Line> lines)
{
  std::vector<shared::LineData> data;
  data.reserve(lines.size());
  for (const Line &line : lines) {
    data.push_back({glm::vec3(line.from_ws - scene_.origin_ws()), line.width_px,
                    glm::vec3(line.to_ws - scene_.origin_ws()), line.is_on_top ? 1U : 0U, line.color});
  }
  const auto bytes = std::as_bytes(std::span(data));
  if (!line_block_ || line_block_.size_bytes() < bytes.size()) {
    // Room for twice as many, so that a growing number of lines makes few buffers.
    const std::size_t limit = scene_.device().limits().storage_block_bytes_max;
    const std::size_t size = std::max(bytes.size(), std::min(2 * bytes.size(), limit));
    line_block_ = scene_.device().create_buffer({"overlay_line_block", gpu::BufferKind::Storage, size});
  }
  scene_.device().update(line_block_, 0, bytes);
}

void Overlay::draw_lines(const draw::View &view, glm::ivec2 size_px, std::span<const Line> lines,
                         const draw::Target &target)
{
  check_up_to_date();
  draw::check(target, size_px);
  check(lines);
  if (!target || lines.empty()) {
    return;
  }
  const bool has_hidden = !std::ranges::all_of(lines, &Line::is_on_top) && update_hiding(view, size_px);
  upload(lines);
  draw::Pass pass("overlay lines", State::WriteColor | State::BlendOver);
  draw::ShadingGroup &group = pass.group(shader(ShaderId::Lines, has_hidden ? Feature::HiddenLines : Feature::None));
  group.bind_storage("line_block", line_block_);
  if (has_hidden) {
    group.bind_texture("objects_texture", hiding_.objects, nearest());
  }
  group.constant("clip_from_world", view.clip_from_world());
  group.constant("origin_px", target.origin_px);
  group.constant("picture_size_px", size_px);
  group.call_procedural(std::uint32_t(2 * lines.size()));
  gpu::CommandList list;
  draw::begin_pass(list, "overlay lines", target, size_px, {{0, 0}, size_px},
                   {.color_load = gpu::LoadAction::Load, .depth_load = gpu::LoadAction::Load});
  pass.record({}, list);
  list.end_pass();
  scene_.device().submit(list);
}

}  // namespace gnomon::overlay
