// SPDX-License-Identifier: MIT
#include "eevee_engine.hh"

#include "eevee_camera.hh"
#include "eevee_shaders.hh"
#include "internal/eevee_engine_data.hh"
#include "internal/eevee_frame.hh"
#include "internal/eevee_material_variants.hh"

#include "draw_view_shared.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gnomon::eevee {

Settings offline_settings(int sample_count)
{
  Settings settings{.sample_count = sample_count};
  ShadowSettings &shadow = settings.shadow;
  // With this number of samples, most of the remaining error is at the edges of shadows. The time to read depths and to
  // draw finer maps is spread over the samples.
  constexpr int fine_shadow_samples = 16;
  if (sample_count == 1) {
    // Texels of about a pixel smooth the edges of shadows, which one sample leaves jagged: less error with less memory.
    shadow.cube_size_px = shadow.cube_size_px * 3 / 4;
    shadow.map_size_px /= 2;
    // The error of these depths is far below that of one sample.
    shadow.can_have_short_maps = true;
  }
  else if (sample_count == 0 || sample_count >= fine_shadow_samples) {
    shadow.is_fitted_to_depth = true;
    shadow.can_have_short_maps = true;
    shadow.cube_size_px *= 2;
    shadow.map_size_px *= 2;
    shadow.esm.size_px *= 2;
  }
  shadow.cascades.can_resize = true;
  if (sample_count > 0) {
    // Texels smaller than about the distance between the samples of a pixel do not reduce the error (decision 0023).
    shadow.cascades.texel_in_pixels_enlarged = std::max(texel_in_pixels, 0.8 / std::sqrt(double(sample_count)));
  }
  return settings;
}

Engine::Engine(render_scene::RenderScene &scene, const Settings &settings)
    : scene_(scene),
      settings_(settings),
      shaders_(std::make_shared<ShaderCache>()),
      emission_(std::make_shared<SceneEmission>())
{
}

/** Check all settings except those of shadows, which SceneShadows::sync checks. \throws gpu::Error */
static void check(const Settings &settings)
{
  if (const std::string fault = scene::limit_fault(settings); !fault.empty()) {
    throw gpu::Error("eevee: {}", fault);
  }
  const bool is_whole = settings.sample_first == 0 && settings.sample_end == 0;
  if (!is_whole && (settings.sample_first < 0 || settings.drawn_sample_count() < 1 ||
                    settings.sample_first + settings.drawn_sample_count() > settings.sample_count)) {
    throw gpu::Error("eevee: samples {} to {} are not within the {} samples of the picture", settings.sample_first,
                     settings.sample_end, settings.sample_count);
  }
  if (!is_whole && settings.noise_threshold > 0.0F) {
    throw gpu::Error("eevee: noise_threshold {} needs all samples of the picture, not {} to {}",
                     settings.noise_threshold, settings.sample_first, settings.sample_end);
  }
}

Data &Engine::data_of(draw::Viewport &viewport) const
{
  return viewport.engine_data<Data>(*this, scene_, shared_);
}

void Engine::init(draw::Viewport &viewport)
{
  Data &data = data_of(viewport);
  data.is_synced = data.is_recorded = false;
  check(settings_);
  data.film.sync(settings_);
  data.adaptive.sync(settings_);
  shaders_->set_pcf(settings_.shadow.pcf);
  take_losses(viewport);
  data.film.make(viewport.device(), viewport.size_px());
}

void Engine::sync_lights(SharedData &shared)
{
  shared.world.sync_occlusion(scene_, settings_);
  if (shared.lights.sync(scene_, settings_, settings_revision_, shaders_->revision(), *emission_, shared.shadows)) {
    shared.shadow_pass.forget_casters();
  }
}

/** Update the features of the viewport after the last sync of the lamps, which another viewport may have made. */
static void follow_lamps(Data &data)
{
  if (data.lights_revision != data.shared->lights.revision()) {
    data.features = with_variant(data.shared->lights.plan().lamps.features | data.shared->shadows.features());
    data.lights_revision = data.shared->lights.revision();
    data.is_recorded = false;
  }
}

void Engine::cache_init(draw::Viewport &viewport)
{
  data_of(viewport).surfaces.begin_sync(scene_.objects().size());
}

void Engine::cache_populate(draw::Viewport &viewport, const draw::ObjectBuffer &objects, draw::ObjectIndex object)
{
  data_of(viewport).surfaces.sync(object, objects.is_mirrored(object));
}

PictureKey Engine::picture_key() const
{
  return {.scene = scene_.revision(), .settings = settings_revision_, .shaders = shaders_->revision()};
}

void Engine::cache_finish(draw::Viewport &viewport)
{
  Data &data = data_of(viewport);
  data.surfaces.end_sync();
  sync_lights(*data.shared);
  follow_lamps(data);
  const PictureKey picture = picture_key();
  if (data.synced_picture != picture) {
    viewport.scene_changed();
    data.depth.feedback().forget();
    data.synced_picture = picture;
  }
  data.is_synced = true;
}

/**
 * Take note of changes since the sync that other viewports or the device made.
 * \throws gpu::Error if the scene, the settings or the programs changed since the sync
 */
void Engine::begin_draw(draw::Viewport &viewport)
{
  Data &data = data_of(viewport);
  if (!data.is_synced) {
    throw gpu::Error("eevee: nothing to draw: the viewport was not synced, or its last sync failed");
  }
  if (!scene_.is_up_to_date()) {
    throw gpu::Error(
        "eevee: the scene was edited since the last update: call RenderScene::update and "
        "draw::Viewport::sync before draw");
  }
  if (data.synced_picture != picture_key()) {
    throw gpu::Error(
        "eevee: the scene, the settings or the programs changed since the last sync of the viewport: call "
        "draw::Viewport::sync before draw");
  }
  take_losses(viewport);
  follow_lamps(data);
}

/** Update the blocks that all passes of a sample read. */
void Engine::update_view(const draw::Viewport &viewport, Data &data, const draw::View &view)
{
  data.shared->materials.follow(scene_);
  scene_.device().update(data.buffers.view_block,
                         view_data(view, viewport, settings_, data.sample_index, scene_.bounds()));
}

void Engine::draw_scene(draw::Viewport &viewport, const draw::View &view)
{
  Data &data = data_of(viewport);
  begin_draw(viewport);
  data.film.make(viewport.device(), viewport.size_px());
  data.output.set(viewport.target());
  data.sample_index = data.adaptive.sample_index(settings_, settings_.sample_first + viewport.samples_drawn());
  data.adaptive.begin_sample(viewport.region().size_px == viewport.size_px());
  if (!viewport.is_writing() && viewport.samples_drawn() == 0 && viewport.part().is_first) {
    data.shadows.begin_picture();
    data.film.begin_picture();
    data.frame.begin_picture();
    data.output.begin_picture();
    data.is_seen = false;
    data.adaptive.begin_picture();
  }
  const bool has_all = viewport.is_writing() || data.film.has_all_samples(settings_, viewport.samples_drawn());
  if (!has_all && !draw_sample(viewport, view)) {
    return;
  }
  if (data.output.target() && data.film.sample_count() > 0) {
    draw_target(viewport, view);
  }
}

bool Engine::draw_sample(draw::Viewport &viewport, const draw::View &view)
{
  Data &data = data_of(viewport);
  const draw::View eye_view = view_through_lens(view, data.sample_index, settings_.sample_count, settings_.seed);
  draw::View sample_view = view_of_sample(view, viewport, settings_, data.sample_index);
  data.visible.update(sample_view, scene_.objects());
  const auto is_visible = [&](draw::ObjectIndex object) { return data.visible.contains(object); };
  const bool is_sample_seen =
      has_background(settings_, scene_) || std::ranges::any_of(data.surfaces.objects(), is_visible);
  data.is_seen |= is_sample_seen;
  data.is_transmission_seen = false;
  data.follow_clip(view);
  const bool awaits_depths = data.is_seen && !viewport.is_moving() && data.depth.awaits(view);
  const bool is_for_feedback = is_sample_seen && awaits_depths && viewport.draws_until_final();
  if (is_sample_seen) {
    data.materials.update(scene_, data.surfaces.objects());
    data.is_transmission_seen =
        std::ranges::any_of(data.materials.transmissive, is_visible, &TransmissiveObject::object);
    if (data.is_transmission_seen) {
      // It shows pixels of other rows.
      viewport.extend_part();
    }
    record(viewport);
    if (is_for_feedback) {
      // Cascades are fitted to the same depths, whatever range of samples is drawn.
      sample_view =
          view_of_sample(view.with_matrices(view.view_from_world(), view.clip_from_view()), viewport, settings_, 0);
      data.visible.update(sample_view, scene_.objects());
    }
    data.blend.order(scene_, sample_view, data.visible, data.materials.transmissive, data.is_transmission_seen);
    update_view(viewport, data, sample_view);
    data.shared->world.follow(view, viewport.device());
  }
  // The first sample is always drawn, because it clears the picture. Later samples are skipped if nothing is visible,
  // unless the means of converged pixels must follow.
  if (is_sample_seen || viewport.samples_drawn() == 0 || data.adaptive.is_active()) {
    FrameSample sample{data.state(settings_), viewport,          view,         eye_view,        sample_view,
                       scene_.bounds(),       data.sample_index, data.visible, is_for_feedback, awaits_depths};
    data.frame.draw(sample, FrameStep::When::EachSample);
  }
  if (is_for_feedback) {
    return false;
  }
  if (viewport.part().is_last) {
    data.film.count_sample(settings_, data.sample_index, viewport.samples_drawn() + 1);
  }
  return true;
}

void Engine::draw_target(draw::Viewport &viewport, const draw::View &view)
{
  Data &data = data_of(viewport);
  if (data.is_seen) {
    data.output.record(viewport, view, *shaders_, settings_, !data.blend.is_empty());
  }
  FrameSample sample{data.state(settings_), viewport,          view,        view, view,
                     scene_.bounds(),       data.sample_index, data.visible};
  data.frame.draw(sample, FrameStep::When::EachTarget);
}

const gpu::Texture &Engine::radiance(draw::Viewport &viewport) const
{
  const gpu::Texture &film = data_of(viewport).film.texture();
  if (!film) {
    throw gpu::Error("eevee: the viewport has no picture: call draw::Viewport::draw before radiance");
  }
  return film;
}

float Engine::radiance_scale(draw::Viewport &viewport) const
{
  return data_of(viewport).film.scale(settings_, viewport.samples_drawn());
}

double Engine::sample_share(draw::Viewport &viewport) const
{
  return data_of(viewport).film.share();
}

bool Engine::is_complete(draw::Viewport &viewport) const
{
  const Data &data = data_of(viewport);
  return data.film.has_all_samples(settings_, viewport.samples_drawn()) && !data.depth.feedback().is_pending();
}

void Engine::finish(draw::Viewport &viewport) const
{
  data_of(viewport).film.finish(settings_, viewport.samples_drawn());
}

void Engine::take_losses(draw::Viewport &viewport)
{
  Data &data = data_of(viewport);
  const std::uint64_t loss_count = viewport.device().loss_count();
  if (data.loss_count != loss_count) {
    data.is_recorded = false;
    // Programs of lost submissions are made anew.
    data.surfaces.forget();
    data.lights.forget();
    data.loss_count = loss_count;
  }
  SharedData &shared = *data.shared;
  if (shared.loss_count != loss_count) {
    shared.lights.forget();
    shared.world.forget();
    shared.shadow_pass.forget();
    shared.shadows.invalidate();
    sync_lights(shared);
    shared.loss_count = loss_count;
  }
}

bool Engine::take_feedback(draw::Viewport &viewport, const gpu::Feedback &feedback)
{
  shaders_->take_failures(feedback);
  Data &data = data_of(viewport);
  if (!viewport.has_depth_texture() || !data.depth.feedback().take(feedback, viewport.depth_texture().id())) {
    return true;
  }
  data.shadows.fit_again();
  return false;
}

std::vector<std::string> Engine::reload_shaders(draw::Viewport &viewport, gpu::ShaderFiles files,
                                                gpu::ShaderReflection reflection)
{
  return shaders_->reload(viewport.device(), std::move(files), std::move(reflection));
}

draw::EngineType engine_type(render_scene::RenderScene &scene, const Settings &settings)
{
  return {"eevee", [&scene, settings] { return std::make_unique<Engine>(scene, settings); }};
}

}  // namespace gnomon::eevee
