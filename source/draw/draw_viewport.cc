// SPDX-License-Identifier: MIT
#include "draw_viewport.hh"

#include <glm/matrix.hpp>

#include <algorithm>
#include <limits>
#include <utility>

namespace gnomon::draw {

static void check_size(const gpu::Device &device, glm::ivec2 size_px)
{
  const int most = device.limits().texture_size_max;
  if (size_px.x < 1 || size_px.y < 1 || size_px.x > most || size_px.y > most) {
    throw gpu::Error("viewport: {}x{} pixels are not from 1x1 to {}x{}", size_px.x, size_px.y, most, most);
  }
}

/** The pixel filter reads the neighbours of each pixel. */
static glm::ivec2 guard_of(const gpu::Device &device, glm::ivec2 size_px)
{
  const int most = device.limits().texture_size_max;
  return {size_px.x + 2 <= most ? 1 : 0, size_px.y + 2 <= most ? 1 : 0};
}

Viewport::Viewport(gpu::Device &device, glm::ivec2 size_px)
    : device_(device), size_px_(size_px), guard_px_(guard_of(device, size_px))
{
  check_size(device, size_px);
}

void Viewport::resize(glm::ivec2 size_px)
{
  check_size(device_, size_px);
  if (size_px == size_px_) {
    return;
  }
  size_px_ = size_px;
  guard_px_ = guard_of(device_, size_px);
  region_ = {};
  restart();
  // Framebuffers must be destroyed before their textures.
  for (auto &[id, engine] : engines_) {
    engine.is_synced = false;
    if (engine.data) {
      engine.data->resized();
    }
  }
  depth_texture_ = {};
}

void Viewport::set_region(const gpu::Rectangle &region)
{
  const glm::ivec2 first_px = region.origin_px;
  const glm::ivec2 last_px = first_px + region.size_px - 1;
  if (!region.is_whole() && (first_px.x < 0 || first_px.y < 0 || last_px.x < first_px.x || last_px.y < first_px.y ||
                             last_px.x >= size_px_.x || last_px.y >= size_px_.y)) {
    throw gpu::Error("viewport: a region of {}x{} px at {},{} is not within the picture of {}x{} px", region.size_px.x,
                     region.size_px.y, first_px.x, first_px.y, size_px_.x, size_px_.y);
  }
  const bool is_whole = region == gpu::Rectangle{{0, 0}, size_px_};
  if (const gpu::Rectangle changed = is_whole ? gpu::Rectangle() : region; changed != region_) {
    region_ = changed;
    restart();
  }
}

gpu::Rectangle Viewport::drawn_region() const
{
  if (region_.is_whole()) {
    return {};
  }
  const glm::ivec2 first_px = glm::max(region_.origin_px + guard_px_ - 1, glm::ivec2(0));
  const glm::ivec2 end_px = glm::min(region_.origin_px + guard_px_ + region_.size_px + 1, drawn_size_px());
  return {first_px, end_px - first_px};
}

View Viewport::drawn_view(const View &view) const
{
  const glm::vec2 scale = glm::vec2(size_px_) / glm::vec2(drawn_size_px());
  glm::mat4 clip_from_view = view.clip_from_view();
  for (int column = 0; column < 4; column++) {
    clip_from_view[column][0] *= scale.x;
    clip_from_view[column][1] *= scale.y;
  }
  return view.with_matrices(view.view_from_world(), clip_from_view, view.lens());
}

const gpu::Texture &Viewport::depth_texture()
{
  if (!depth_texture_) {
    const glm::ivec2 drawn_px = drawn_size_px();
    depth_texture_ = device_.create_texture(
        {.name = "depth", .format = gpu::Format::Depth32F, .width = drawn_px.x, .height = drawn_px.y});
  }
  return depth_texture_;
}

void Viewport::sync(std::span<Engine *const> engines, const ObjectBuffer &objects)
{
  for (Engine *engine : engines) {
    // Clear the revision until the sync is complete: if it fails, the engine may know only some of the objects.
    const std::optional<std::uint64_t> seen = std::exchange(engines_[engine->id()].synced_revision, std::nullopt);
    engines_[engine->id()].is_synced = false;
    const bool is_anew = !seen || objects.structure_revision() > *seen;
    engine->init(*this);
    if (is_anew) {
      engine->cache_init(*this);
    }
    if (is_anew || objects.revision() > *seen) {
      for (ObjectIndex index = object_identity + 1; index < objects.index_end(); index++) {
        if (objects.is_live(index) && (is_anew || objects.revision(index) > *seen)) {
          engine->cache_populate(*this, objects, index);
        }
      }
    }
    engine->cache_finish(*this);
    engines_[engine->id()].synced_revision = objects.revision();
    engines_[engine->id()].is_synced = true;
  }
}

void Viewport::check_synced(std::span<Engine *const> engines) const
{
  for (const Engine *engine : engines) {
    const auto found = engines_.find(engine->id());
    if (found == engines_.end() || !found->second.is_synced) {
      throw gpu::Error(
          "viewport: {} was not synced since the viewport was made or resized, or its last sync failed: call "
          "draw::Viewport::sync before draw",
          engine->name());
    }
  }
}

void Viewport::draw(std::span<Engine *const> engines, const View &view, const Target &target)
{
  check_synced(engines);
  if (!is_finite(view.clip_from_world()) || !is_finite(glm::mat4(glm::inverse(glm::dmat4(view.view_from_world()))))) {
    throw gpu::Error("the view's matrix, or its inverse, is not finite");
  }
  check(target, size_px_);
  check_region(target);
  target_ = target;
  const bool is_restarted = !is_of(engines, is_moving_ ? view_ : view);
  view_ = view;
  if (is_restarted) {
    drawn_by_.clear();
    std::ranges::transform(engines, std::back_inserter(drawn_by_), &Engine::id);
    restart();
  }
  try {
    if (device_.is_recording()) {
      draw_sample(engines, false);
    }
    else {
      draw_until_final(engines);
    }
  }
  catch (...) {
    // Discard the picture, because a sample may be drawn only partly.
    restart();
    throw;
  }
}

void Viewport::check_region(const Target &target) const
{
  if (!region_.is_whole() && target && size_in(target, size_px_) != size_px_) {
    throw gpu::Error("target: a region of a picture cannot be scaled");
  }
}

void Viewport::write(std::span<Engine *const> engines, const Target &target)
{
  check_synced(engines);
  if (samples_drawn_ == 0) {
    throw gpu::Error("viewport: there is no picture to write: call draw::Viewport::draw before write");
  }
  check(target, size_px_);
  check_region(target);
  target_ = target;
  is_writing_ = true;
  try {
    const View drawn = drawn_view(view_);
    const auto draw_all = [&] {
      for (Engine *engine : engines) {
        engine->draw_scene(*this, drawn);
      }
    };
    if (device_.is_recording()) {
      draw_all();
    }
    else {
      device_.run(packet_, draw_all);
    }
  }
  catch (...) {
    is_writing_ = false;
    restart();
    throw;
  }
  is_writing_ = false;
}

bool Viewport::is_of(std::span<Engine *const> engines, const View &view) const
{
  return view == view_ && std::ranges::equal(engines, drawn_by_, {}, &Engine::id);
}

int Viewport::row_count() const
{
  return region_.is_whole() ? drawn_size_px().y : drawn_region().size_px.y;
}

void Viewport::begin_part(std::size_t engine_count)
{
  const int left = rows_left();
  const int count = engine_count == 1 ? std::min(rows_max_, left) : left;
  part_ = {.is_first = !next_row_,
           .is_last = count == left,
           .row = next_row_.value_or(0),
           .row_count = count,
           .setup_max = engine_count == 1 && count == 0 ? setup_max_ : no_setup_max};
  setup_count_ = 0;
  setup_left_ = 0;
}

void Viewport::set_setup(int unit_count, int left_count)
{
  setup_count_ = unit_count;
  setup_left_ = left_count;
  if (left_count > 0) {
    part_.row_count = 0;
    part_.is_last = false;
  }
}

void Viewport::extend_part()
{
  part_.row_count = row_count() - part_.row;
  part_.is_last = true;
}

void Viewport::end_part()
{
  if (!part_.is_last) {
    next_row_ = part_.row + part_.row_count;
    return;
  }
  next_row_.reset();
  samples_drawn_ = std::min(samples_drawn_, std::numeric_limits<int>::max() - 1) + 1;
}

gpu::Rectangle Viewport::part_region() const
{
  if (part_.row_count == row_count()) {
    return drawn_region();
  }
  const gpu::Rectangle all = region_.is_whole() ? gpu::Rectangle{{0, 0}, drawn_size_px()} : drawn_region();
  return {all.origin_px + glm::ivec2(0, part_.row), {all.size_px.x, part_.row_count}};
}

void Viewport::draw_sample(std::span<Engine *const> engines, bool is_until_final)
{
  draws_until_final_ = is_until_final;
  if (std::exchange(loss_count_, device_.loss_count()) != device_.loss_count()) {
    restart();
  }
  begin_part(engines.size());
  const View drawn = drawn_view(view_);
  for (Engine *engine : engines) {
    engine->draw_scene(*this, drawn);
  }
  end_part();
}

void Viewport::draw_until_final(std::span<Engine *const> engines)
{
  // The first draw yields the feedback of this view, with which the second draw is final.
  bool is_final = false;
  for (int i = 0; i < 2 && !is_final; i++) {
    device_.run(packet_, [&] { draw_sample(engines, i == 0); });
    is_final = take_feedback(engines, packet_.feedback());
  }
}

bool Viewport::take_feedback(std::span<Engine *const> engines, const gpu::Feedback &feedback)
{
  bool is_final = true;
  for (Engine *engine : engines) {
    is_final &= engine->take_feedback(*this, feedback);
  }
  if (!is_final) {
    restart();
  }
  return is_final;
}

}  // namespace gnomon::draw
