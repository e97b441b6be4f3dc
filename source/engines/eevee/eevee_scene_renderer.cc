// SPDX-License-Identifier: MIT
#include "eevee_scene_renderer.hh"

#include "eevee_camera.hh"

namespace gnomon::eevee {

void SceneRenderer::sync()
{
  is_synced_ = false;
  render_scene_.update();
  const std::array<draw::Engine *, 1> engines = {&engine_};
  viewport_.sync(engines, render_scene_.objects());
  is_synced_ = true;
}

draw::View SceneRenderer::view_of(const scene::PlacedCamera &camera) const
{
  return eevee::view_of(camera, viewport_.size_px(), render_scene_.origin_ws());
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

bool SceneRenderer::draw_sample(const scene::PlacedCamera &camera, const draw::Target &target)
{
  const glm::dvec3 origin_ws =
      render_scene::origin_near(glm::dvec3(camera.world_from_camera[3]), render_scene_.origin_ws());
  if (origin_ws != render_scene_.origin_ws()) {
    render_scene_.set_origin(origin_ws);
    sync();
  }
  const std::array<draw::Engine *, 1> engines = {&engine_};
  viewport_.draw(engines, view_of(camera), target);
  return engine_.is_complete(viewport_);
}

bool SceneRenderer::draw(const scene::PlacedCamera &camera, const Progress &progress, const draw::Target &target)
{
  viewport_.restart();
  for (int i = 0; i < settings_.sample_count; i++) {
    draw_sample(camera, i + 1 == settings_.sample_count ? target : draw::Target());
    if (progress && !progress(i + 1)) {
      return i + 1 == settings_.sample_count;
    }
  }
  return true;
}

}  // namespace gnomon::eevee
