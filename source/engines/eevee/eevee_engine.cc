// SPDX-License-Identifier: MIT
#include "eevee_engine.hh"

#include "eevee_camera.hh"
#include "eevee_engine_data.hh"
#include "eevee_film.hh"
#include "eevee_materials.hh"

#include "draw_view_shared.h"
#include "gpu_read.hh"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::eevee {

namespace {

using gpu::State;

/** The device's time for what \a work submits, added to the step's. */
template <typename Work>
void timed(bool is_timed, gpu::Device &device, Timing &timing, const char *name, Work &&work)
{
  if (!is_timed) {
    work();
    return;
  }
  auto step = std::ranges::find(timing.steps, name, &Timing::Step::name);
  if (step == timing.steps.end()) {
    timing.steps.push_back({name, device.create_timer_query(name)});
    step = timing.steps.end() - 1;
  }
  if (step->is_pending) {
    step->seconds += device.elapsed_seconds(step->query).value_or(0.0);
  }
  device.time_begin(step->query);
  work();
  device.time_end(step->query);
  step->is_pending = true;
}

gpu::Texture picture(gpu::Device &device, const char *name, gpu::Format format, glm::ivec2 size_px)
{
  return device.create_texture({.name = name, .format = format, .width = size_px.x, .height = size_px.y});
}

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

const gpu::Batch &batch_of(gpu::Device &device, StorageList &stl, const scene::Scene &scene, std::uint32_t mesh_index,
                           bool needs_uvs)
{
  MeshBatch &made = stl.batches[mesh_index];
  const scene::Mesh &mesh = scene.meshes[mesh_index];
  if (!made.batch || made.revision != mesh.revision || (needs_uvs && !made.has_uvs)) {
    made.revision = mesh.revision;
    made.has_uvs = needs_uvs;
    made.batch = device.create_batch({mesh.name, mesh.positions, mesh.normals, mesh.indices,
                                      needs_uvs ? std::span(mesh.uvs) : std::span<const glm::vec2>()});
  }
  return made.batch;
}

ShaderId shadow_shader(LayerPass layer_pass)
{
  switch (layer_pass) {
    case LayerPass::Layered: return ShaderId::ShadowLayered;
    case LayerPass::Geometry: return ShaderId::ShadowGeometry;
    default: return ShaderId::Shadow;
  }
}

State culled_state(CasterFaces faces)
{
  switch (faces) {
    case CasterFaces::Front: return State::CullBack;
    case CasterFaces::Back: return State::CullFront;
    default: return State::None;
  }
}

/** What makes a caster's shadow, as plain numbers. */
std::uint64_t caster_fingerprint(const draw::ObjectRef &object, std::uint32_t mesh_index, const scene::Mesh &mesh,
                                 const scene::Scene &scene)
{
  const scene::Material &material = scene.materials[mesh.material];
  struct {
    glm::mat4 world_from_object;
    std::uint64_t revision;
    std::uint32_t mesh_index;
    std::uint32_t is_double_sided;
    std::int32_t mask;
    std::uint32_t image;
    std::uint32_t wrap_u;
    std::uint32_t wrap_v;
    float alpha;
    float alpha_cutoff;
  } key = {object.world_from_object, mesh.revision, mesh_index, material.is_double_sided ? 1U : 0U, -2, 0, 0, 0, 0, 0};
  if (is_masked(material)) {
    key.mask = material.base_color_texture;
    if (key.mask >= 0) {
      const scene::Texture &texture = scene.textures[std::size_t(key.mask)];
      key.image = texture.image;
      key.wrap_u = std::uint32_t(texture.wrap_u);
      key.wrap_v = std::uint32_t(texture.wrap_v);
    }
    key.alpha = material.alpha;
    key.alpha_cutoff = material.alpha_cutoff;
  }
  return fingerprint_of(std::as_bytes(std::span(&key, 1)));
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

void bind_lit(draw::ShadingGroup &group, StorageList &stl)
{
  group.bind_uniform("view_block", stl.view_block);
  group.bind_storage_ref("object_block", &stl.object_block);
  group.bind_storage("material_block", stl.material_block);
  group.bind_uniform("light_block", stl.light_block);
  stl.shadows.bind(group);
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
  TextureList &txl = data.txl;
  if (!txl.film) {
    txl.film = picture(device, "film", gpu::Format::RGBA32F, viewport.size_px());
    data.fbl.film_fb = device.create_framebuffer({.name = "film_fb", .colors = {{&txl.film}}, .depth = {}});
  }
  if (settings_.has_display && !txl.display) {
    txl.display = picture(device, "display", gpu::Format::RGBA8, viewport.size_px());
    data.fbl.display_fb = device.create_framebuffer({.name = "display_fb", .colors = {{&txl.display}}, .depth = {}});
  }
}

void Engine::cache_init(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  StorageList &stl = data.stl;
  data.is_synced = data.is_recorded = false;
  data.psl = std::make_unique<PassList>(viewport.objects());
  data.samples_drawn = 0;
  stl.groups.clear();
  stl.textures.clear();
  stl.objects.clear();
  stl.caster_calls.assign(scene_.meshes.size(), {});
  stl.shaders.set_pcf(settings_.shadow.pcf);
  stl.batches.resize(scene_.meshes.size());

  stl.lamps = make_lamps(scene_);
  stl.shadows.sync(viewport.device().limits(), scene_, stl.lamps, settings_.shadow);
  stl.features = stl.lamps.features | stl.shadows.features();
  stl.tinted_light = settings_.has_cascade_tint ? first_sun_with_maps(stl.lamps) : std::nullopt;
  stl.film_weight_sum = film_weight_sum(settings_.sample_count, settings_.seed);
}

void Engine::cache_populate(draw::Viewport &viewport, const draw::ObjectRef &object)
{
  const scene::Mesh &mesh = scene_.meshes[scene_.objects[object.index].mesh];
  if (is_seen(scene_.materials[mesh.material])) {
    viewport.engine_data<Data>(*this).stl.objects.push_back(object);
  }
}

void Engine::cache_finish(draw::Viewport &viewport)
{
  viewport.engine_data<Data>(*this).is_synced = true;
}

/** What a picture needs in which anything is seen. */
void Engine::make_targets(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  gpu::Device &device = viewport.device();
  auto &[fbl, txl, psl, stl, timing, samples_drawn, shadow_picture, is_synced, is_recorded, is_seen, passes] = data;
  if (!txl.radiance) {
    txl.radiance = picture(device, "radiance", gpu::Format::RGBA32F, viewport.size_px());
    fbl.depth_fb = device.create_framebuffer({.name = "depth_fb", .colors = {}, .depth = {&viewport.depth_texture()}});
    fbl.main_fb = device.create_framebuffer(
        {.name = "main_fb", .colors = {{&txl.radiance}}, .depth = {&viewport.depth_texture()}});
    stl.view_block = device.create_buffer({"view_block", gpu::BufferKind::Uniform, sizeof(shared::ViewData)});
    txl.nearest = device.create_sampler({.name = "nearest"});
  }
  if (settings_.has_probe && !txl.probe_position) {
    txl.probe_position = picture(device, "probe_position", gpu::Format::RGBA32F, viewport.size_px());
    txl.probe_normal = picture(device, "probe_normal", gpu::Format::RGBA32F, viewport.size_px());
    fbl.probe_fb = device.create_framebuffer({.name = "probe_fb",
                                              .colors = {{&txl.probe_position}, {&txl.probe_normal}},
                                              .depth = {&viewport.depth_texture()}});
  }
}

void Engine::make_blocks(draw::Viewport &viewport)
{
  StorageList &stl = viewport.engine_data<Data>(*this).stl;
  gpu::Device &device = viewport.device();
  const std::vector<shared::MaterialData> materials = make_materials(scene_);
  const auto bytes = std::as_bytes(std::span(materials));
  if (!stl.material_block || stl.material_block.size_bytes() != bytes.size()) {
    stl.material_block = device.create_buffer({"material_block", gpu::BufferKind::Storage, bytes.size()});
  }
  device.update(stl.material_block, 0, bytes);
  if (!has(stl.features, Feature::Light)) {
    stl.light_block = {};
    return;
  }
  std::vector<shared::MaterialData> used;
  for (const draw::ObjectRef &object : stl.objects) {
    used.push_back(materials[scene_.meshes[scene_.objects[object.index].mesh].material]);
  }
  stl.features = stl.features | material_features(used);
  if (!stl.light_block) {
    stl.light_block = device.create_buffer({"light_block", gpu::BufferKind::Uniform, sizeof(shared::LightBlock)});
  }
  device.update(stl.light_block, stl.lamps.light_block);
}

void Engine::record_film(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  StorageList &stl = data.stl;
  draw::ShadingGroup &film = data.psl->film_pass.group(stl.shaders.get(viewport.device(), ShaderId::Film));
  film.bind_texture("radiance_texture", data.txl.radiance, data.txl.nearest);
  film.constant_ref("column_weights", &stl.film_columns);
  film.constant_ref("row_weights", &stl.film_rows);
  film.call_procedural();
  if (settings_.has_display) {
    draw::ShadingGroup &tonemap = data.psl->tonemap.group(stl.shaders.get(viewport.device(), ShaderId::Tonemap));
    tonemap.bind_texture("radiance_texture", data.txl.film, data.txl.nearest);
    tonemap.constant("view_transform", int(settings_.view_transform));
    tonemap.constant("exposure_scale", std::exp2(settings_.exposure));
    tonemap.call_procedural();
  }
}

void Engine::record(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  if (data.is_recorded) {
    return;
  }
  // Until it comes to its end: a half of it must not be drawn.
  data.is_synced = false;
  make_targets(viewport);
  make_blocks(viewport);
  data.stl.shadows.allocate(viewport.device(), data.stl.shaders);
  for (const draw::ObjectRef &object : data.stl.objects) {
    record_object(viewport, object);
  }
  data.stl.shadows.finish();
  record_film(viewport);
  viewport.objects().upload(viewport.device());
  data.is_synced = data.is_recorded = true;
}

void Engine::record_object(draw::Viewport &viewport, const draw::ObjectRef &object)
{
  Data &data = viewport.engine_data<Data>(*this);
  StorageList &stl = data.stl;
  gpu::Device &device = viewport.device();
  const scene::Mesh &mesh = scene_.meshes[scene_.objects[object.index].mesh];
  const scene::Material &material = scene_.materials[mesh.material];
  const bool has_mask = is_masked(material);
  const bool is_lit_textured = material.base_color_texture >= 0 && (has_mask || has(stl.features, Feature::Light));
  const gpu::Batch &batch = batch_of(device, stl, scene_, scene_.objects[object.index].mesh, is_lit_textured);
  const draw::ObjectIndex index = viewport.objects().add(object.world_from_object, mesh.material);
  const State winding = draw::is_mirrored(object.world_from_object) ? State::FrontClockwise : State::None;

  /** The group of a pass; \a bind fills in a new one. */
  const auto group_of = [&](draw::Pass &pass, const gpu::Shader &shader, State state, bool is_textured,
                            const auto &bind) -> draw::ShadingGroup & {
    const std::int32_t texture = is_textured ? material.base_color_texture : -1;
    draw::ShadingGroup *&group = stl.groups[{&pass, state, texture}];
    if (!group) {
      group = &pass.group(shader);
      group->state_enable(state);
      bind(*group);
      if (is_textured) {
        const auto [image, sampler] = stl.textures.get(device, scene_, std::size_t(texture));
        group->bind_texture("base_color_texture", image, sampler);
      }
    }
    return *group;
  };
  const auto call = [&](draw::Pass &pass, const gpu::Shader &shader, State state, bool is_textured) {
    const auto bind = [&stl](draw::ShadingGroup &group) { bind_lit(group, stl); };
    group_of(pass, shader, state | winding, is_textured, bind).call(batch, index, object.volume);
  };
  const Feature mask = has_mask ? Feature::AlphaMask : Feature::None;
  const gpu::Shader &depth_shader = stl.shaders.get(device, ShaderId::Depth, mask);
  const gpu::Shader &lit_shader = stl.shaders.get(
      device, ShaderId::Lit, stl.features | (is_lit_textured ? Feature::BaseColorTexture : Feature::None));
  if (material.is_double_sided) {
    call(data.psl->depth_pass, depth_shader, State::None, has_mask);
    call(data.psl->pass, lit_shader, State::None, is_lit_textured);
  }
  else {
    call(data.psl->depth_pass_cull, depth_shader, State::None, has_mask);
    // At the same depth as the front of another face, the back must not be drawn over it.
    call(data.psl->pass, lit_shader, State::CullBack, is_lit_textured);
  }

  const State side = material.is_double_sided ? State::None : State::CullBack;
  if (stl.tinted_light) {
    const auto bind = [&stl](draw::ShadingGroup &group) {
      bind_lit(group, stl);
      group.constant("tinted_light", *stl.tinted_light);
    };
    const gpu::Shader &tint_shader = stl.shaders.get(device, ShaderId::DebugCascades, stl.features);
    group_of(data.psl->tint_pass, tint_shader, side | winding, false, bind).call(batch, index, object.volume);
  }
  if (settings_.has_probe && has(stl.features, Feature::Light)) {
    const auto bind = [&stl](draw::ShadingGroup &group) {
      bind_lit(group, stl);
      group.constant_ref("probed_light", &stl.probed_light);
    };
    const gpu::Shader &probe_shader = stl.shaders.get(device, ShaderId::Probe, stl.features);
    group_of(data.psl->probe_pass, probe_shader, side | winding, false, bind).call(batch, index, object.volume);
  }

  if (has(stl.features, any_shadow)) {
    const std::uint32_t mesh_index = scene_.objects[object.index].mesh;
    draw::InstanceCall *&instances = stl.caster_calls[mesh_index][winding == State::None ? 0 : 1];
    if (!instances) {
      const auto bind = [&stl](draw::ShadingGroup &group) {
        group.bind_storage_ref("object_block", &stl.object_block);
        group.bind_storage("material_block", stl.material_block);
        group.bind_uniform_ref("shadow_render_block", stl.shadows.render_block());
      };
      const ShaderId id = shadow_shader(stl.shadows.layer_pass());
      const State faces = material.is_double_sided ? State::None : culled_state(settings_.shadow.caster_faces);
      // Without culling the winding makes no difference.
      const State state = faces == State::None ? State::None : faces | winding;
      instances =
          &group_of(data.psl->shadow_pass, stl.shaders.get(device, id, mask), state, has_mask, bind).instances(batch);
    }
    stl.shadows.add_caster({scene::transformed(mesh.bounds, object.world_from_object), index, instances,
                            caster_fingerprint(object, mesh_index, mesh, scene_), &mesh, &object.world_from_object});
  }
}

/** What a failed sync leaves can be synced again, and not be drawn. */
static void require_sync(bool is_synced)
{
  if (!is_synced) {
    throw gpu::Error("eevee: nothing to draw, as the last sync of the viewport failed");
  }
}

/** Edge of a pixel at distance 1, or, orthographic, anywhere, metres. */
static float pixel_size(const draw::View &view, const draw::Viewport &viewport)
{
  return 2.0F / (view.clip_from_view()[1][1] * float(viewport.size_px().y));
}

void Engine::draw_scene(draw::Viewport &viewport, const draw::View &view)
{
  Data &data = viewport.engine_data<Data>(*this);
  require_sync(data.is_synced);
  const glm::vec2 offset_px = film_offset_px(data.samples_drawn, settings_.sample_count, settings_.seed);
  const draw::View sample_view = with_sample_offset(view, offset_px, viewport.size_px());
  const bool is_first = data.samples_drawn == 0;
  if (is_first) {
    data.stl.shadows.begin_picture();
    data.passes.clear();
    data.is_seen = false;
  }
  if (std::ranges::any_of(data.stl.objects, [&](const auto &object) { return sample_view.touches(object.volume); })) {
    data.is_seen = true;
    record(viewport);
    draw_sample(viewport, view, sample_view);
  }
  else if (is_first) {
    submit_pass(viewport, "film", data.fbl.film_fb, {}, {}, sample_view);
  }
  data.samples_drawn = (data.samples_drawn + 1) % settings_.sample_count;
  if (settings_.has_display && data.samples_drawn == 0) {
    if (data.is_seen) {
      submit_pass(viewport, "tonemap", data.fbl.display_fb, {.color_load = gpu::LoadAction::DontCare},
                  {&data.psl->tonemap}, sample_view);
    }
    else {
      // Black is black whatever the transform, and has no alpha: the clear is all that a picture of nothing takes.
      submit_pass(viewport, "tonemap", data.fbl.display_fb, {}, {}, sample_view);
    }
  }
}

void Engine::submit_pass(draw::Viewport &viewport, const char *name, const gpu::Framebuffer &framebuffer,
                         const gpu::PassActions &actions, std::initializer_list<const draw::Pass *> passes,
                         const draw::View &view)
{
  Data &data = viewport.engine_data<Data>(*this);
  gpu::CommandList list;
  list.begin_pass(name, framebuffer, actions);
  for (const draw::Pass *pass : passes) {
    PassRuns &runs = data.passes[pass->name()];
    const draw::RecordCounts counts = pass->record(view, list);
    runs.runs += counts.drawn > 0 ? 1 : 0;
    runs.counts.drawn += counts.drawn;
    runs.counts.culled += counts.culled;
  }
  list.end_pass();
  timed(settings_.is_timed, viewport.device(), data.timing, name, [&] { viewport.device().submit(list); });
}

void Engine::draw_sample(draw::Viewport &viewport, const draw::View &view, const draw::View &sample_view)
{
  Data &data = viewport.engine_data<Data>(*this);
  auto &[fbl, txl, psl, stl, timing, samples_drawn, shadow_picture, is_synced, is_recorded, is_seen, passes] = data;
  gpu::Device &device = viewport.device();
  stl.object_block = {viewport.objects().buffer().id()};
  device.update(stl.view_block, view_data(sample_view));

  const auto draw_depth = [&] {
    submit_pass(viewport, "depth_prepass", fbl.depth_fb, {}, {&psl->depth_pass, &psl->depth_pass_cull}, sample_view);
  };
  const bool is_depth_first = settings_.shadow.cascades.is_fitted_to_depth;
  if (is_depth_first) {
    draw_depth();
  }
  if (has(stl.features, any_shadow)) {
    const auto read_depths = [&] { return gpu::read_as<float>(device, viewport.depth_texture()); };
    gpu::CommandList list;
    stl.shadows.update(device, view, pixel_size(view, viewport), psl->shadow_pass, list, read_depths);
    if (!list.commands().empty()) {
      timed(settings_.is_timed, device, timing, "shadows", [&] { device.submit(list); });
    }
  }
  if (!is_depth_first) {
    draw_depth();
  }
  submit_pass(viewport, "lit", fbl.main_fb, {.depth_load = gpu::LoadAction::Load}, {&psl->pass, &psl->tint_pass},
              sample_view);

  const FilmWeights weights = film_weights(samples_drawn, settings_.sample_count, settings_.seed, stl.film_weight_sum);
  stl.film_columns = glm::vec4(weights.columns, 0.0F);
  stl.film_rows = glm::vec4(weights.rows, 0.0F);
  const gpu::LoadAction load = samples_drawn == 0 ? gpu::LoadAction::Clear : gpu::LoadAction::Load;
  submit_pass(viewport, "film", fbl.film_fb, {.color_load = load}, {&psl->film_pass}, sample_view);
}

static std::optional<std::size_t> light_of(const Lamps &lamps, std::size_t lamp)
{
  const auto found = std::ranges::find(lamps.scene_index, std::uint32_t(lamp));
  return found == lamps.scene_index.end() ? std::nullopt
                                          : std::optional(std::size_t(found - lamps.scene_index.begin()));
}

std::optional<Probe> Engine::probe(draw::Viewport &viewport, const draw::View &view, std::size_t lamp)
{
  GNOMON_ASSERT(settings_.has_probe, "the settings ask for no probe");
  Data &data = viewport.engine_data<Data>(*this);
  require_sync(data.is_synced);
  StorageList &stl = data.stl;
  const std::optional<std::size_t> light = light_of(stl.lamps, lamp);
  if (!light || stl.objects.empty()) {
    return std::nullopt;
  }
  record(viewport);
  const auto &[fbl, txl, psl] = std::tie(data.fbl, data.txl, data.psl);
  gpu::Device &device = viewport.device();
  stl.probed_light = int(*light);
  stl.object_block = {viewport.objects().buffer().id()};
  device.update(stl.view_block, view_data(view));
  gpu::CommandList list;
  stl.shadows.update(device, view, pixel_size(view, viewport), psl->shadow_pass, list);
  list.begin_pass("depth_prepass", fbl.depth_fb, {});
  psl->depth_pass.record(view, list);
  psl->depth_pass_cull.record(view, list);
  list.end_pass();
  list.begin_pass("probe", fbl.probe_fb, {.depth_load = gpu::LoadAction::Load});
  psl->probe_pass.record(view, list);
  list.end_pass();
  device.submit(list);
  return Probe{gpu::read_as<glm::vec4>(device, txl.probe_position), gpu::read_as<glm::vec4>(device, txl.probe_normal)};
}

double Engine::shadow_texel_size(draw::Viewport &viewport, std::size_t lamp, const glm::dvec3 &position_ws) const
{
  const StorageList &stl = viewport.engine_data<Data>(*this).stl;
  const std::optional<std::size_t> light = light_of(stl.lamps, lamp);
  return light ? stl.shadows.texel_size(stl.lamps.light_block.lights[*light], position_ws) : 0.0;
}

const Shadows &Engine::shadows(draw::Viewport &viewport) const
{
  return viewport.engine_data<Data>(*this).stl.shadows;
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
                                                gpu::ShaderReflection reflection) const
{
  StorageList &stl = viewport.engine_data<Data>(*this).stl;
  stl.shadows.invalidate();
  return stl.shaders.reload(viewport.device(), std::move(files), std::move(reflection));
}

void Engine::invalidate_shadows(draw::Viewport &viewport) const
{
  viewport.engine_data<Data>(*this).stl.shadows.invalidate();
}

std::string Engine::serialize_passes(draw::Viewport &viewport) const
{
  const Data &data = viewport.engine_data<Data>(*this);
  std::string text;
  for (const draw::Pass *pass :
       {&data.psl->shadow_pass, &data.psl->depth_pass, &data.psl->depth_pass_cull, &data.psl->pass,
        &data.psl->tint_pass, &data.psl->probe_pass, &data.psl->film_pass, &data.psl->tonemap}) {
    text += pass->serialize(viewport.device());
  }
  return text;
}

static std::optional<ShadowLayers> layers_of(const StorageList &stl, std::size_t lamp)
{
  const std::optional<std::size_t> light = light_of(stl.lamps, lamp);
  return light ? stl.shadows.layers(stl.lamps.light_block.lights[*light]) : std::nullopt;
}

std::vector<std::string> Engine::shadow_layers(draw::Viewport &viewport, std::size_t lamp) const
{
  const std::optional<ShadowLayers> layers = layers_of(viewport.engine_data<Data>(*this).stl, lamp);
  std::vector<std::string> names;
  for (int i = 0; layers && i < layers->count; i++) {
    names.push_back(layers->esm_format >= 0 ? "octahedral" : std::to_string(i));
  }
  return names;
}

const gpu::Texture &Engine::shadow_picture(draw::Viewport &viewport, std::size_t lamp, std::optional<std::size_t> layer)
{
  Data &data = viewport.engine_data<Data>(*this);
  const std::optional<ShadowLayers> layers = layers_of(data.stl, lamp);
  GNOMON_ASSERT(layers, "lamp {} has no shadow", lamp);
  return data.shadow_picture.draw(viewport.device(), data.stl.shaders, *layers,
                                  layer ? std::optional(int(*layer)) : std::nullopt);
}

std::optional<std::size_t> Engine::tinted_sun(draw::Viewport &viewport) const
{
  const StorageList &stl = viewport.engine_data<Data>(*this).stl;
  return stl.tinted_light ? std::optional(std::size_t(stl.lamps.scene_index[std::size_t(*stl.tinted_light)]))
                          : std::nullopt;
}

draw::EngineType engine_type(const scene::Scene &scene, const Settings &settings)
{
  return {"eevee", [&scene, settings] { return std::make_unique<Engine>(scene, settings); }};
}

std::vector<draw::ObjectRef> object_refs(const scene::Scene &scene)
{
  std::vector<draw::ObjectRef> refs;
  refs.reserve(scene.objects.size());
  for (std::uint32_t i = 0; i < scene.objects.size(); i++) {
    const scene::Object &object = scene.objects[i];
    const scene::Bounds bounds = scene::transformed(scene.meshes[object.mesh].bounds, object.world_from_object);
    refs.push_back({i, object.world_from_object, {bounds.center(), bounds.radius()}});
  }
  return refs;
}

}  // namespace gnomon::eevee
