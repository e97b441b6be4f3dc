// SPDX-License-Identifier: MIT
#include "eevee_engine.hh"

#include "eevee_camera.hh"
#include "eevee_engine_data.hh"
#include "eevee_film.hh"
#include "eevee_frame.hh"

#include "draw_view_shared.h"
#include "gpu_read.hh"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::eevee {

namespace {

shared::ViewData view_data(const draw::View &view)
{
  const glm::mat4 world_from_view(glm::inverse(glm::dmat4(view.view_from_world())));
  shared::ViewData data{};
  data.clip_from_world = view.clip_from_world();
  data.position_ws = glm::vec3(world_from_view[3]);
  data.is_perspective = view.is_perspective() ? 1 : 0;
  data.back_ws = glm::normalize(glm::vec3(world_from_view[2]));
  return data;
}

/** In light_block. */
std::optional<int> first_sun_with_maps(const Lamps &lamps)
{
  for (int i = 0; i < lamps.light_block.light_count; i++) {
    const shared::LightData &light = lamps.light_block.lights[i];
    if (light.kind == LIGHT_SUN && light.shadow_kind == SHADOW_MAP) {
      return i;
    }
  }
  return std::nullopt;
}

}  // namespace

/** \throws gpu::Error for those of the frame; those of shadows are the shadows' business. */
static void check(const Settings &settings)
{
  if (settings.sample_count < 1) {
    throw gpu::Error("eevee: sample_count {} is not at least 1", settings.sample_count);
  }
  // Its power of 2 is finite, and no denormal.
  constexpr float exposure_max = 120.0F;
  if (!(std::abs(settings.exposure) <= exposure_max)) {
    throw gpu::Error("eevee: exposure {} is not in [{}, {}]", settings.exposure, -exposure_max, exposure_max);
  }
}

void Engine::init(draw::Viewport &viewport)
{
  check(settings_);
  Data &data = viewport.engine_data<Data>(*this);
  gpu::Device &device = viewport.device();
  data.is_synced = data.is_recorded = false;
  data.samples_drawn = 0;
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
  data.stl.film_weight_sum = film_weight_sum(settings_.sample_count, settings_.seed);
  shaders_.set_pcf(settings_.shadow.pcf);
  TextureList &txl = data.txl;
  if (!txl.film) {
    txl.film = create_target(device, "film", gpu::Format::RGBA32F, viewport.size_px());
    data.fbl.film_fb = device.create_framebuffer({.name = "film_fb", .colors = {{&txl.film}}, .depth = {}});
  }
  if (settings_.has_display && !txl.display) {
    txl.display = create_target(device, "display", gpu::Format::RGBA8, viewport.size_px());
    data.fbl.display_fb = device.create_framebuffer({.name = "display_fb", .colors = {{&txl.display}}, .depth = {}});
  }
}

/** Which lamps give light, and which have a shadow of which kind and size. Needs no device. */
void Engine::sync_lamps(SharedData &shared, const gpu::Limits &device_limits)
{
  const ShadowsKey key{scene_.lamps_revision(), scene_.objects().revision(), scene_.passes_revision(),
                       settings_revision_,      shaders_revision_,           shared.shadows.viewports_revision()};
  if (shared.synced == key) {
    return;
  }
  shared.synced.reset();
  shared.has_casters = false;
  shared.is_light_block_written = false;
  shared.revision++;
  shared.lamps = make_lamps(scene_.lamps());
  shared.shadows.sync(device_limits, shadow_lamps(scene_.lamps(), shared.lamps), scene_.bounds(),
                      shared.lamps.light_block, settings_.shadow);
  shared.tinted_light = settings_.has_cascade_tint ? first_sun_with_maps(shared.lamps) : std::nullopt;
  shared.synced = key;
}

/** Take note of the last sync of the lamps, which another viewport may have asked for. */
static void follow_lamps(Data &data)
{
  if (data.stl.shared_revision != data.shared->revision) {
    data.stl.features = data.shared->lamps.features | data.shared->shadows.features();
    data.stl.shared_revision = data.shared->revision;
    data.is_recorded = false;
  }
}

void Engine::cache_init(draw::Viewport &viewport)
{
  StorageList &stl = viewport.engine_data<Data>(*this).stl;
  stl.objects.clear();
  stl.is_collecting = true;
}

void Engine::cache_populate(draw::Viewport &viewport, const draw::ObjectBuffer &objects, draw::ObjectIndex object)
{
  StorageList &stl = viewport.engine_data<Data>(*this).stl;
  if (stl.is_collecting) {
    stl.objects.push_back(object);
  }
  else if (object < stl.is_mirrored.size()) {
    stl.is_winding_changed |= stl.is_mirrored[object] != draw::is_mirrored(objects.world_from_object(object));
  }
}

void Engine::cache_finish(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  data.stl.is_collecting = false;
  sync_lamps(*data.shared, viewport.device().limits());
  follow_lamps(data);
  data.is_synced = true;
}

/** What a failed sync leaves can be synced again, and not be drawn. */
static void require_sync(bool is_synced)
{
  if (!is_synced) {
    throw gpu::Error("eevee: nothing to draw, as the last sync of the viewport failed");
  }
}

/** Write what every pass of a sample reads. */
void Engine::update_view(Data &data, const draw::View &view)
{
  data.stl.object_block = data.shared->object_block = {scene_.objects().buffer().id()};
  data.stl.material_block = data.shared->material_block = {scene_.materials().buffer().id()};
  scene_.device().update(data.stl.view_block, view_data(view));
}

void Engine::draw_scene(draw::Viewport &viewport, const draw::View &view)
{
  Data &data = viewport.engine_data<Data>(*this);
  require_sync(data.is_synced);
  follow_lamps(data);
  const glm::vec2 offset_px = film_offset_px(data.samples_drawn, settings_.sample_count, settings_.seed);
  const draw::View sample_view = with_sample_offset(view, offset_px, viewport.size_px());
  if (data.samples_drawn == 0) {
    data.stl.shadows->begin_picture();
    data.frame.clear();
    data.is_seen = false;
  }
  const bool is_sample_seen = std::ranges::any_of(
      data.stl.objects, [&](draw::ObjectIndex object) { return sample_view.touches(scene_.objects().volume(object)); });
  FrameSample sample{data, settings_, viewport, view, sample_view};
  if (is_sample_seen) {
    data.is_seen = true;
    record(viewport);
    update_view(data, sample_view);
  }
  // A sample that sees nothing adds nothing to a picture that has begun.
  if (is_sample_seen || data.samples_drawn == 0) {
    draw_steps(sample, FrameStep::When::EachSample);
  }
  data.samples_drawn = (data.samples_drawn + 1) % settings_.sample_count;
  if (data.samples_drawn == 0) {
    draw_steps(sample, FrameStep::When::LastSample);
  }
}

/** In light_block. Nothing where the lamp gives no light, or the viewport was never synced. */
static std::optional<std::size_t> light_of(const Data &data, std::size_t lamp)
{
  if (!data.shared) {
    return std::nullopt;
  }
  const Lamps &lamps = data.shared->lamps;
  const auto found = std::ranges::find(lamps.lamp_index, std::uint32_t(lamp));
  return found == lamps.lamp_index.end() ? std::nullopt : std::optional(std::size_t(found - lamps.lamp_index.begin()));
}

std::optional<Probe> Engine::probe(draw::Viewport &viewport, const draw::View &view, std::size_t lamp)
{
  GNOMON_ASSERT(settings_.has_probe, "the settings ask for no probe");
  Data &data = viewport.engine_data<Data>(*this);
  require_sync(data.is_synced);
  follow_lamps(data);
  StorageList &stl = data.stl;
  const std::optional<std::size_t> light = light_of(data, lamp);
  if (!light || stl.objects.empty()) {
    return std::nullopt;
  }
  record(viewport);
  const auto &[fbl, txl, psl] = std::tie(data.fbl, data.txl, data.psl);
  gpu::Device &device = viewport.device();
  stl.probed_light = int(*light);
  update_view(data, view);
  gpu::CommandList list;
  stl.shadows->update(device, view, pixel_size(view, viewport), data.shared->shadow_pass, list);
  list.begin_pass("depth_prepass", fbl.depth_fb, {});
  psl->depth_pass.record(view, list);
  psl->depth_pass_cull.record(view, list);
  list.end_pass();
  list.begin_pass("probe", fbl.probe_fb, {.depth_load = gpu::LoadAction::Load});
  psl->probe_pass.record(view, list);
  list.end_pass();
  device.submit(list);
  stl.shadows->submitted();
  return Probe{gpu::read_as<glm::vec4>(device, txl.probe_position), gpu::read_as<glm::vec4>(device, txl.probe_normal)};
}

double Engine::shadow_texel_size(draw::Viewport &viewport, std::size_t lamp, const glm::dvec3 &position_ws) const
{
  const Data &data = viewport.engine_data<Data>(*this);
  const std::optional<std::size_t> light = light_of(data, lamp);
  return light ? data.stl.shadows->texel_size(data.shared->lamps.light_block.lights[*light], position_ws) : 0.0;
}

const Shadows &Engine::shadows(draw::Viewport &viewport) const
{
  const Data &data = viewport.engine_data<Data>(*this);
  GNOMON_ASSERT(data.stl.shadows, "the viewport was never synced");
  return *data.stl.shadows;
}

const gpu::Texture &Engine::radiance(draw::Viewport &viewport) const
{
  return viewport.engine_data<Data>(*this).txl.film;
}

const gpu::Texture &Engine::display(draw::Viewport &viewport) const
{
  GNOMON_ASSERT(settings_.has_display, "the settings ask for no display picture");
  return viewport.engine_data<Data>(*this).txl.display;
}

std::vector<StepTime> Engine::take_step_times(draw::Viewport &viewport) const
{
  std::vector<StepTime> times;
  for (Timing::Step &step : viewport.engine_data<Data>(*this).timing.steps) {
    if (std::exchange(step.is_pending, false)) {
      const std::optional<double> seconds = viewport.device().elapsed_seconds(step.query);
      step.seconds += seconds.value_or(0.0);
      step.taken_seconds = seconds ? std::optional(step.seconds) : std::nullopt;
      times.push_back({step.name, step.seconds});
    }
    step.seconds = 0.0;
  }
  return times;
}

std::vector<std::string> Engine::reload_shaders(draw::Viewport &viewport, gpu::ShaderFiles files,
                                                gpu::ShaderReflection reflection)
{
  invalidate_shadows(viewport);
  shaders_revision_++;
  return shaders_.reload(viewport.device(), std::move(files), std::move(reflection));
}

void Engine::invalidate_shadows(draw::Viewport &viewport) const
{
  if (const Data &data = viewport.engine_data<Data>(*this); data.shared) {
    data.shared->shadows.invalidate();
  }
}

std::string Engine::serialize_passes(draw::Viewport &viewport) const
{
  const Data &data = viewport.engine_data<Data>(*this);
  std::string text;
  if (!data.psl) {
    return text;
  }
  text += data.shared->shadow_pass.serialize(viewport.device());
  for (const FrameStep &step : frame_steps()) {
    for (const FramePass &pass : step.passes) {
      text += ((*data.psl).*pass.pass).serialize(viewport.device());
    }
  }
  text += data.psl->probe_pass.serialize(viewport.device());
  return text;
}

static std::optional<ShadowLayers> layers_of(const Data &data, std::size_t lamp)
{
  const std::optional<std::size_t> light = light_of(data, lamp);
  return light ? data.stl.shadows->layers(data.shared->lamps.light_block.lights[*light]) : std::nullopt;
}

std::vector<std::string> Engine::shadow_layers(draw::Viewport &viewport, std::size_t lamp) const
{
  const std::optional<ShadowLayers> layers = layers_of(viewport.engine_data<Data>(*this), lamp);
  std::vector<std::string> names;
  for (int i = 0; layers && i < layers->count; i++) {
    names.push_back(layers->esm_format >= 0 ? "octahedral" : std::to_string(i));
  }
  return names;
}

const gpu::Texture &Engine::shadow_picture(draw::Viewport &viewport, std::size_t lamp, std::optional<std::size_t> layer)
{
  Data &data = viewport.engine_data<Data>(*this);
  const std::optional<ShadowLayers> layers = layers_of(data, lamp);
  GNOMON_ASSERT(layers, "lamp {} has no shadow", lamp);
  return data.shadow_picture.draw(viewport.device(), shaders_, *layers,
                                  layer ? std::optional(int(*layer)) : std::nullopt);
}

std::optional<std::size_t> Engine::tinted_sun(draw::Viewport &viewport) const
{
  const Data &data = viewport.engine_data<Data>(*this);
  if (!data.shared || !data.shared->tinted_light) {
    return std::nullopt;
  }
  return data.shared->lamps.lamp_index[std::size_t(*data.shared->tinted_light)];
}

draw::EngineType engine_type(render_scene::RenderScene &scene, const Settings &settings)
{
  return {"eevee", [&scene, settings] { return std::make_unique<Engine>(scene, settings); }};
}

}  // namespace gnomon::eevee
