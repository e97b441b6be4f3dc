// SPDX-License-Identifier: MIT
#include "internal/eevee_background.hh"

#include <glm/matrix.hpp>

#include <numbers>

namespace gnomon::eevee {

glm::vec4 background_color(const Settings &settings, const render_scene::RenderScene &scene)
{
  if (!has_background(settings, scene)) {
    return glm::vec4(0.0F);
  }
  const std::optional<scene::World> &world = scene.scene().world();
  const bool is_color = settings.background.kind == Background::Kind::Color;
  return {is_color ? settings.background.color : world->strength * world->color, 1.0F};
}

void BackgroundPass::record(ShaderCache &shaders, const render_scene::RenderScene &scene, const Settings &settings)
{
  pass_.clear();
  if (!has_background(settings, scene)) {
    return;
  }
  const std::optional<scene::World> &world = scene.scene().world();
  const bool is_picture = bool(world_.picture());
  draw::ShadingGroup &group =
      pass_.group(shaders.get(scene.device(), is_picture ? ShaderId::BackgroundWorld : ShaderId::BackgroundColor));
  group.constant("color", background_color(settings, scene));
  if (is_picture) {
    group.bind_texture("world_picture", world_.picture(), world_.picture_sampler());
    group.constant_ref("corner", &corner_);
    group.constant_ref("across", &across_);
    group.constant_ref("up", &up_);
    group.constant("turn", world->rotation / (2.0F * std::numbers::pi_v<float>));
  }
  group.call_procedural();
}

void BackgroundPass::set_rays(const FrameSample &sample)
{
  const glm::dmat4 projection(sample.sample_view.clip_from_view());
  const glm::dmat3 world_from_view = glm::transpose(glm::dmat3(sample.sample_view.view_from_world()));
  const glm::dvec2 size_px(sample.viewport.drawn_size_px());
  // The view ray through the normalized device coordinates (x, y) is (middle + scale * (x, y), -1) in view space. In an
  // orthographic view all rays are parallel.
  const bool is_perspective = sample.sample_view.is_perspective();
  const glm::dvec2 scale = is_perspective ? 1.0 / glm::dvec2(projection[0][0], projection[1][1]) : glm::dvec2(0.0);
  const glm::dvec2 middle = is_perspective ? scale * glm::dvec2(projection[2][0], projection[2][1]) : glm::dvec2(0.0);
  corner_ = glm::vec4(glm::vec3(world_from_view * glm::dvec3(middle - scale, -1.0)), 0.0F);
  across_ = glm::vec4(glm::vec3(world_from_view * glm::dvec3(2.0 * scale.x / size_px.x, 0.0, 0.0)), 0.0F);
  up_ = glm::vec4(glm::vec3(world_from_view * glm::dvec3(0.0, 2.0 * scale.y / size_px.y, 0.0)), 0.0F);
}

FrameStep BackgroundPass::step()
{
  return {.name = "background",
          .summary = "The world behind the objects, if the background shows it.",
          .part = FrameStep::Part::Rows,
          .need =
              [this](const FrameState &state) {
                return state.settings.background.kind == Background::Kind::None
                           ? Need{false, "the settings have no background"}
                       : pass_.is_empty() ? Need{false, "the scene has no world"}
                                          : Need{true, "pixels without a surface"};
              },
          .reads = {"depth"},
          .writes = {"radiance"},
          .passes = {{&pass_, "pixels without a surface"}},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                set_rays(sample);
                record_pass(sample, list, buffers_.main_fb, drawn_over(sample.read_region()));
              }};
}

}  // namespace gnomon::eevee
