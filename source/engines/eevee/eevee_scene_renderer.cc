// SPDX-License-Identifier: MIT
#include "eevee_scene_renderer.hh"

#include "eevee_camera.hh"
#include "eevee_sequence_shared.h"

#include "gpu_read.hh"
#include "trace.hh"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

namespace gnomon::eevee {

void SceneRenderer::sync()
{
  const trace::Span span("sync");
  is_synced_ = false;
  render_scene_.update();
  const std::array<draw::Engine *, 1> engines = {&engine_};
  viewport_.sync(engines, render_scene_.objects());
  is_synced_ = true;
}

void SceneRenderer::set_clip_planes(std::vector<glm::dvec4> planes_ws)
{
  // This checks them: the caller learns of a fault here and not in a later draw.
  static_cast<void>(draw::View().with_clip_planes(render_scene_.relative(planes_ws)));
  clip_planes_ws_ = std::move(planes_ws);
}

draw::View SceneRenderer::view_of(const scene::PlacedCamera &camera) const
{
  const draw::View view = eevee::view_of(camera, viewport_.size_px(), render_scene_.origin_ws())
                              .with_clip_planes(render_scene_.relative(clip_planes_ws_));
  return hidden_.empty() && isolated_.empty() ? view
                                              : view.with_hidden(render_scene_.hidden_objects(hidden_, isolated_));
}

bool SceneRenderer::prepare(gpu::Packet &packet, const scene::PlacedCamera &camera, const draw::Target &target)
{
  const std::array<draw::Engine *, 1> engines = {&engine_};
  viewport_.take_feedback(engines, packet.feedback());
  const gpu::Recording recording(viewport_.device(), packet);
  if (!is_synced_ || !render_scene_.is_up_to_date()) {
    sync();
  }
  return draw_sample(camera, target);
}

void SceneRenderer::follow(const scene::PlacedCamera &camera)
{
  // Before the scene takes its position.
  render_scene::check(camera);
  const glm::dvec3 origin_ws = render_scene::origin_near(glm::dvec3(camera.world_from_camera[3]),
                                                         render_scene_.origin_ws(), render_scene_.bounds());
  if (origin_ws != render_scene_.origin_ws()) {
    render_scene_.set_origin(origin_ws);
    sync();
  }
}

void SceneRenderer::check_synced() const
{
  if (!is_synced_ || !render_scene_.is_up_to_date()) {
    throw gpu::Error("eevee: {}: call SceneRenderer::sync before a draw",
                     is_synced_ ? "the scene was edited since the last sync"
                                : "the renderer was not synced, its settings or size changed since, or its last sync "
                                  "failed");
  }
}

bool SceneRenderer::draw_sample(const scene::PlacedCamera &camera, const draw::Target &target)
{
  check_synced();
  follow(camera);
  const std::array<draw::Engine *, 1> engines = {&engine_};
  viewport_.draw(engines, view_of(camera), target);
  return engine_.is_complete(viewport_);
}

bool SceneRenderer::draw_within(double budget_seconds, const scene::PlacedCamera &camera, const draw::Target &target)
{
  if (!budgeted_) {
    budgeted_.emplace(render_scene_, engine_, viewport_);
  }
  budgeted_->begin(budget_seconds);
  if (!is_synced_ || !render_scene_.is_up_to_date()) {
    sync();
  }
  follow(camera);
  return budgeted_->draw(view_of(camera), target);
}

void SceneRenderer::write_shown(const draw::Target &target)
{
  if (!budgeted_) {
    throw gpu::Error("eevee: there is no picture to write: call SceneRenderer::draw_within before write_shown");
  }
  budgeted_->write(target);
}

int SceneRenderer::draw(const scene::PlacedCamera &camera, const DrawLimits &limits, const draw::Target &target)
{
  return draw_all([&](int) { return camera; }, limits, target);
}

int SceneRenderer::draw_moving(const Pose &pose, const DrawLimits &limits, const draw::Target &target)
{
  constexpr std::uint32_t stream = 0x73687574;
  struct Moving {
    draw::Viewport &viewport;
    explicit Moving(draw::Viewport &viewport_) : viewport(viewport_)
    {
      viewport.set_moving(true);
    }
    ~Moving()
    {
      viewport.set_moving(false);
    }
  };
  const Moving moving(viewport_);
  const auto camera_of = [&](int index) {
    const auto number = std::uint32_t(settings_.sample_first + index);
    const std::uint32_t place = shared::scrambled_van_der_corput(number, settings_.seed + stream);
    scene::PlacedCamera camera = pose(double(shared::to_unit(place)));
    sync();
    return camera;
  };
  return draw_all(camera_of, limits, target);
}

int SceneRenderer::draw_all(const std::function<scene::PlacedCamera(int index)> &camera_of, const DrawLimits &limits,
                            const draw::Target &target)
{
  using Seconds = std::chrono::duration<double>;
  const bool is_timed = std::isfinite(limits.seconds_max);
  if (settings_.sample_count == 0 && !limits.progress && !is_timed) {
    throw gpu::Error("eevee: nothing limits the number of samples of the picture");
  }
  const auto start = std::chrono::steady_clock::now();
  viewport_.restart();
  double seconds = 0.0;
  for (int i = 1;; i++) {
    const bool is_last = i == settings_.drawn_sample_count();
    const scene::PlacedCamera camera = camera_of(i - 1);
    draw_sample(camera, is_last ? target : draw::Target());
    bool is_ended = limits.progress && !limits.progress(i);
    if (is_last) {
      return i;
    }
    if (is_timed) {
      viewport_.device().finish();
      const double sample_start = std::exchange(seconds, Seconds(std::chrono::steady_clock::now() - start).count());
      is_ended = is_ended || seconds + (seconds - sample_start) > limits.seconds_max;
    }
    if (is_ended) {
      engine_.finish(viewport_);
      if (target) {
        draw_sample(camera, target);
      }
      return i;
    }
  }
}

std::vector<glm::vec4> SceneRenderer::read_picture()
{
  if (viewport_.samples_drawn() == 0) {
    throw gpu::Error("eevee: there is no picture to read: call SceneRenderer::draw or draw_sample before read_picture");
  }
  std::vector<glm::vec4> picture = gpu::read_as<glm::vec4>(viewport_.device(), engine_.radiance(viewport_));
  if (const float scale = engine_.radiance_scale(viewport_); scale != 1.0F) {
    std::ranges::transform(picture, picture.begin(), [&](const glm::vec4 &pixel) { return pixel * scale; });
  }
  return picture;
}

}  // namespace gnomon::eevee
