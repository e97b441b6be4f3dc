// SPDX-License-Identifier: MIT
#include "eevee_engine.hh"

#include "eevee_camera.hh"
#include "eevee_engine_data.hh"
#include "eevee_film.hh"
#include "eevee_frame.hh"
#include "eevee_material_variants.hh"

#include "draw_view_shared.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gnomon::eevee {

namespace {

/** Index in Lamps::lights of the first sun with shadow maps. */
std::optional<int> first_sun_with_maps(const Lamps &lamps)
{
  for (int i = 0; i < lamps.light_count(); i++) {
    const shared::LightData &light = lamps.lights[std::size_t(i)];
    if (light.kind == LIGHT_SUN && light.shadow_kind == SHADOW_MAP) {
      return i;
    }
  }
  return std::nullopt;
}

}  // namespace

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

void Engine::init(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  data.is_synced = data.is_recorded = false;
  check(settings_);
  if (!data.psl) {
    data.psl = std::make_unique<PassList>(scene_.objects());
  }
  if (!data.shared) {
    data.shared = shared_.lock();
    if (!data.shared) {
      data.shared = std::make_shared<SharedData>(scene_.objects());
      shared_ = data.shared;
    }
    data.stl.shadows.emplace(data.shared->shadows);
  }
  data.stl.sample_step = sample_step(settings_);
  data.stl.film_weight_sum = film_weight_sum(settings_.sample_count, settings_.seed);
  shaders_->set_pcf(settings_.shadow.pcf);
  take_losses(viewport);
  make_film(viewport);
}

void Engine::make_film(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  gpu::Device &device = viewport.device();
  TextureList &txl = data.txl;
  if (!data.fbl.film_fb) {
    txl.film = create_target(device, "film", gpu::Format::RGBA32F, viewport.size_px());
    data.fbl.film_fb = device.create_framebuffer({.name = "film_fb", .colors = {{&txl.film}}, .depth = {}});
  }
}

/** Update the lights and plan their shadows if their inputs changed. Creates no resources on the device. */
void Engine::sync_lamps(SharedData &shared, const gpu::Limits &device_limits)
{
  const int emissive_count = settings_.planned_sample_count() > 1 ? settings_.emissive_point_count : 0;
  shared.emission.update(scene_, emissive_count > 0);
  const ShadowsKey key{scene_.lamps_revision(),    scene_.objects().revision(),   scene_.passes_revision(),
                       settings_revision_,         shaders_->revision(),          shared.shadows.viewports_revision(),
                       shared.emission.revision(), scene_.host_content_revision()};
  if (shared.synced == key) {
    return;
  }
  if (shared.synced && shared.synced->shaders != key.shaders) {
    // Other programs draw other shadows.
    shared.shadows.invalidate();
  }
  shared.synced.reset();
  shared.has_casters = false;
  shared.are_lights_written = false;
  shared.revision++;
  const LampShading shading = settings_.planned_sample_count() > 1 ? LampShading::Point : LampShading::Whole;
  const std::shared_ptr<const render_scene::WorldLight> &world = scene_.world();
  shared.placed.assign(scene_.lamps().begin(), scene_.lamps().end());
  for (scene::PlacedLamp &lamp : shared.placed) {
    lower_range(lamp, settings_.light_threshold);
  }
  const std::size_t emission_first = shared.placed.size();
  if (shared.emission.surfaces()) {
    std::ranges::copy(emission_lamps(emissive_count, scene_.bounds()), std::back_inserter(shared.placed));
  }
  const std::size_t world_first = shared.placed.size();
  if (world) {
    std::ranges::copy(world_lamps(*world, shading), std::back_inserter(shared.placed));
  }
  const int device_most = device_limits.buffer_texels_max / LIGHT_TEXELS;
  Lamps lamps = make_lamps(shared.placed, shading, std::size_t(std::clamp(device_most, LIGHT_MAX, LIGHT_COUNT_MAX)));
  const bool has_reaches = lamps.reaches == shared.lamps.reaches &&
                           lamps.cube_light_count == shared.lamps.cube_light_count &&
                           lamps.cube_everywhere_count == shared.lamps.cube_everywhere_count;
  shared.reaches_revision += has_reaches ? 0 : 1;
  shared.lamps = std::move(lamps);
  if (shared.lamps.local_count() >= settings_.clustered_lamps_min || shared.lamps.light_count() > LIGHT_MAX) {
    shared.lamps.features = shared.lamps.features | Feature::LightClusters;
  }
  if (world) {
    shared.lamps.features = shared.lamps.features | Feature::Light | Feature::World;
    set_kind(shared.lamps, world_first + world->suns.size(), shared.placed.size(), LIGHT_WORLD);
  }
  set_kind(shared.lamps, emission_first, world_first, LIGHT_SURFACE);
  if (shading == LampShading::Point) {
    set_highlights(shared.lamps, shared.placed, emission_first, settings_.planned_sample_count(), scene_.bounds());
  }
  ShadowSettings shadow = settings_.shadow;
  // These surfaces receive shadows, and the depths that are read back do not have them.
  shadow.is_fitted_to_depth &= !has_surfaces_without_depth(scene_.scene());
  shared.shadows.sync(device_limits, shadow_lamps(shared.placed, shared.lamps, shading), scene_.bounds(),
                      shared.lamps.lights, shadow);
  const scene::Bounds &bounds_ws = scene_.bounds();
  shared.bounds_ws = bounds_ws;
  shared.lamp_points =
      shading == LampShading::Point
          ? LampPoints(shared.placed, shared.lamps, bounds_ws.is_empty() ? glm::vec3(0.0F) : bounds_ws.center(), world,
                       settings_.planned_sample_count(), shared.emission.surfaces(), emissive_count)
          : LampPoints();
  shared.is_light_left_out.clear();
  for (int i = 0; i < shared.lamps.light_count(); i++) {
    const std::size_t lamp = shared.lamps.lamp_index[std::size_t(i)];
    const LightPart::Kind part = lamp < emission_first ? LightPart::Kind::Lamp
                                 : lamp < world_first  ? LightPart::Kind::Emission
                                                       : LightPart::Kind::World;
    const bool is_kept =
        settings_.light.has(part) && (settings_.light.kind != LightPart::Kind::Lamp || settings_.light.lamp == lamp);
    shared.is_light_left_out.push_back(!is_kept);
    if (!is_kept) {
      leave_out(shared.lamps.lights[std::size_t(i)]);
    }
  }
  shared.tinted_light = settings_.has_cascade_tint ? first_sun_with_maps(shared.lamps) : std::nullopt;
  shared.synced = key;
}

/** Update the features of the viewport after the last sync of the lamps, which another viewport may have made. */
static void follow_lamps(Data &data)
{
  if (data.stl.shared_revision != data.shared->revision) {
    data.stl.features = with_variant(data.shared->lamps.features | data.shared->shadows.features());
    data.stl.shared_revision = data.shared->revision;
    data.is_recorded = false;
  }
}

void Engine::cache_init(draw::Viewport &viewport)
{
  StorageList &stl = viewport.engine_data<Data>(*this).stl;
  stl.objects.clear();
  stl.objects.reserve(scene_.objects().size());
  stl.is_collecting = true;
}

void Engine::cache_populate(draw::Viewport &viewport, const draw::ObjectBuffer &objects, draw::ObjectIndex object)
{
  StorageList &stl = viewport.engine_data<Data>(*this).stl;
  if (stl.is_collecting) {
    stl.objects.push_back(object);
  }
  else if (object < stl.is_mirrored.size()) {
    stl.is_winding_changed |= stl.is_mirrored[object] != objects.is_mirrored(object);
  }
}

PictureKey Engine::picture_key() const
{
  return {scene_.objects().revision(),   scene_.lamps_revision(), scene_.passes_revision(),
          scene_.materials_revision(),   settings_revision_,      shaders_->revision(),
          scene_.host_content_revision()};
}

void Engine::cache_finish(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  data.stl.is_collecting = false;
  sync_lamps(*data.shared, viewport.device().limits());
  follow_lamps(data);
  const PictureKey picture = picture_key();
  if (data.stl.synced_picture != picture) {
    viewport.restart();
    data.depth_feedback.forget();
    data.stl.synced_picture = picture;
  }
  data.is_synced = true;
}

/**
 * Take note of changes since the sync that other viewports or the device made.
 * \throws gpu::Error if the scene, the settings or the programs changed since the sync
 */
void Engine::begin_draw(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  if (!data.is_synced) {
    throw gpu::Error("eevee: nothing to draw: the viewport was not synced, or its last sync failed");
  }
  if (!scene_.is_up_to_date()) {
    throw gpu::Error(
        "eevee: the scene was edited since the last update: call RenderScene::update and "
        "draw::Viewport::sync before draw");
  }
  if (data.stl.synced_picture != picture_key()) {
    throw gpu::Error(
        "eevee: the scene, the settings or the programs changed since the last sync of the viewport: call "
        "draw::Viewport::sync before draw");
  }
  take_losses(viewport);
  follow_lamps(data);
}

/** Update the blocks that all passes of a sample read. */
void Engine::update_view(Data &data, const draw::View &view)
{
  data.shared->object_block = {scene_.objects().buffer().id()};
  const std::optional<render_scene::MaterialTable> &dark = data.shared->materials_without_emission;
  const render_scene::MaterialTable &materials = dark ? *dark : scene_.materials();
  data.stl.material_block = data.shared->material_block = {materials.buffer().id()};
  data.stl.full_material_block = data.shared->full_material_block = {materials.full_buffer().id()};
  data.stl.layer_block = {materials.layer_buffer().id()};
  scene_.device().update(data.stl.view_block, view_data(view, settings_, data.sample_index, scene_.bounds()));
}

void Engine::draw_scene(draw::Viewport &viewport, const draw::View &view)
{
  Data &data = viewport.engine_data<Data>(*this);
  begin_draw(viewport);
  make_film(viewport);
  data.target = viewport.target();
  const int position = settings_.sample_first + viewport.samples_drawn();
  data.sample_index = settings_.sample_count == 0
                          ? position
                          : int(std::int64_t(position) * data.stl.sample_step % settings_.sample_count);
  data.adaptive.is_whole_picture = viewport.region().size_px == viewport.size_px();
  if (!viewport.is_writing() && viewport.samples_drawn() == 0 && viewport.part().is_first) {
    data.stl.shadows->begin_picture();
    data.stl.film_share = 0.0;
    std::ranges::for_each(data.frame, &StepRecord::reset);
    data.is_seen = data.has_picture_depth = data.is_finished = false;
    data.film_sample_count = 0;
    data.adaptive.is_tested = data.adaptive.is_active = false;
  }
  const bool has_all = viewport.is_writing() || has_all_samples(data, viewport.samples_drawn());
  if (!has_all && !draw_sample(viewport, view)) {
    return;
  }
  if (data.target && data.film_sample_count > 0) {
    draw_target(viewport, view);
  }
}

bool Engine::draw_sample(draw::Viewport &viewport, const draw::View &view)
{
  Data &data = viewport.engine_data<Data>(*this);
  draw::View sample_view = view_of_sample(view, viewport, settings_, data.sample_index);
  data.visible.update(sample_view, scene_.objects());
  const auto is_visible = [&](draw::ObjectIndex object) { return data.visible.contains(object); };
  const bool is_sample_seen = has_background(settings_, scene_) || std::ranges::any_of(data.stl.objects, is_visible);
  FrameSample sample{data, settings_, viewport, view, sample_view};
  data.is_transmission_seen = false;
  if (is_sample_seen) {
    data.is_seen = true;
    sync_materials(data.stl);
    data.is_transmission_seen = std::ranges::any_of(data.stl.transmissive, is_visible, &TransmissiveObject::object);
    if (data.is_transmission_seen) {
      // It shows pixels of other rows.
      viewport.extend_part();
    }
    record(viewport);
    sample.is_for_feedback = viewport.draws_until_final() && awaits_depths(data, view);
    if (sample.is_for_feedback) {
      // Cascades are fitted to the same depths, whatever range of samples is drawn.
      sample_view = view_of_sample(view, viewport, settings_, 0);
    }
    order_blended(data, sample_view);
    update_view(data, sample_view);
  }
  // The first sample is always drawn, because it clears the picture. Later samples are skipped if nothing is visible,
  // unless the means of converged pixels must follow.
  if (is_sample_seen || viewport.samples_drawn() == 0 || data.adaptive.is_active) {
    draw_steps(sample, FrameStep::When::EachSample);
    data.stl.lamp_points_memory = std::move(sample.lamp_points);
  }
  if (sample.is_for_feedback) {
    return false;
  }
  if (viewport.part().is_last) {
    data.stl.film_share +=
        film_share(data.sample_index, settings_.sample_count, settings_.seed, data.stl.film_weight_sum);
    data.film_sample_count = viewport.samples_drawn() + 1;
  }
  return true;
}

void Engine::draw_target(draw::Viewport &viewport, const draw::View &view)
{
  Data &data = viewport.engine_data<Data>(*this);
  if (data.is_seen) {
    record_tonemap(viewport, view);
  }
  FrameSample sample{data, settings_, viewport, view, view};
  draw_steps(sample, FrameStep::When::EachTarget);
}

const gpu::Texture &Engine::radiance(draw::Viewport &viewport) const
{
  const gpu::Texture &film = viewport.engine_data<Data>(*this).txl.film;
  if (!film) {
    throw gpu::Error("eevee: the viewport has no picture: call draw::Viewport::draw before radiance");
  }
  return film;
}

float Engine::sample_scale(const Data &data, int samples_drawn) const
{
  const bool has_counted_samples = settings_.sample_count > 0 && samples_drawn >= settings_.sample_count &&
                                   settings_.drawn_sample_count() == settings_.sample_count;
  return (has_counted_samples && !data.is_finished) || data.stl.film_share == 0.0 ? 1.0F
                                                                                  : float(1.0 / data.stl.film_share);
}

float Engine::radiance_scale(draw::Viewport &viewport) const
{
  return sample_scale(viewport.engine_data<Data>(*this), viewport.samples_drawn());
}

double Engine::sample_share(draw::Viewport &viewport) const
{
  return viewport.engine_data<Data>(*this).stl.film_share;
}

bool Engine::has_all_samples(const Data &data, int samples_drawn) const
{
  return data.is_finished || (settings_.sample_count > 0 && samples_drawn >= settings_.drawn_sample_count());
}

bool Engine::is_complete(draw::Viewport &viewport) const
{
  const Data &data = viewport.engine_data<Data>(*this);
  return has_all_samples(data, viewport.samples_drawn()) && !data.depth_feedback.is_pending();
}

void Engine::finish(draw::Viewport &viewport) const
{
  Data &data = viewport.engine_data<Data>(*this);
  data.is_finished =
      data.is_finished || (viewport.samples_drawn() > 0 && !has_all_samples(data, viewport.samples_drawn()));
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
