// SPDX-License-Identifier: MIT
#include "eevee_engine.hh"

#include "eevee_camera.hh"
#include "eevee_film.hh"
#include "eevee_lamps.hh"
#include "eevee_materials.hh"

#include "draw_view_shared.h"

#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace gnomon::eevee {

namespace {

using gpu::State;

struct FramebufferList {
  gpu::Framebuffer depth_fb;
  gpu::Framebuffer main_fb;
  gpu::Framebuffer film_fb;
  gpu::Framebuffer display_fb;
};

struct TextureList {
  gpu::Texture radiance;
  /** Sum of the weighted samples. */
  gpu::Texture film;
  gpu::Texture display;
  gpu::Sampler nearest;
};

struct PassList {
  explicit PassList(draw::ObjectBuffer &objects)
      : shadow_pass("shadow_pass", State::WriteDepth | State::DepthNearerEqual | State::DepthClamp, &objects),
        depth_pass("depth_pass", State::WriteDepth | State::DepthNearerEqual, &objects),
        depth_pass_cull("depth_pass_cull", State::WriteDepth | State::DepthNearerEqual | State::CullBack, &objects),
        pass("pass", State::WriteColor | State::DepthEqual, &objects),
        film_pass("film_pass", State::WriteColor | State::BlendAdd),
        tonemap("tonemap", State::WriteColor)
  {
  }
  draw::Pass shadow_pass;
  draw::Pass depth_pass;
  draw::Pass depth_pass_cull;
  draw::Pass pass;
  draw::Pass film_pass;
  draw::Pass tonemap;
};

/** A pass's groups for either winding; made when the first object needs them. */
struct Groups {
  draw::ShadingGroup *straight = nullptr;
  draw::ShadingGroup *mirrored = nullptr;
};

struct StorageList {
  Lamps lamps;
  Shadows shadows;
  Feature features = Feature::None;
  ShaderCache shaders;
  /** One a mesh of the scene; empty until an object uses it. */
  std::vector<gpu::Batch> batches;
  gpu::Buffer view_block;
  gpu::Buffer light_block;
  gpu::Buffer material_block;
  gpu::BufferRange object_block;
  Groups depth;
  Groups depth_cull;
  Groups lit;
  Groups lit_cull;
  /** Of casters whose sides both throw shadows, and of those that CasterFaces is about. */
  Groups shadow;
  Groups shadow_cull;
  /** One a mesh of the scene and winding; empty until a caster uses it. */
  std::vector<std::array<draw::InstanceCall *, 2>> caster_calls;
  /** Of the sample being drawn; the film pass reads it by reference. */
  glm::vec4 film_columns{0.0F};
  glm::vec4 film_rows{0.0F};
  double film_weight_sum = 0.0;
};

struct Timing {
  struct Step {
    std::string name;
    gpu::TimerQuery query;
    bool is_pending = false;
    double seconds = 0.0;
  };
  std::vector<Step> steps;
};

struct Data final : draw::EngineViewportData {
  FramebufferList fbl;
  TextureList txl;
  std::unique_ptr<PassList> psl;
  StorageList stl;
  Timing timing;
  int samples_drawn = 0;
};

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

const gpu::Batch &batch_of(gpu::Device &device, StorageList &stl, const scene::Scene &scene, std::uint32_t mesh_index)
{
  gpu::Batch &batch = stl.batches[mesh_index];
  if (!batch) {
    const scene::Mesh &mesh = scene.meshes[mesh_index];
    batch = device.create_batch({mesh.name, mesh.positions, mesh.normals, mesh.indices});
  }
  return batch;
}

ShaderId shadow_shader(LayerPass layer_pass)
{
  switch (layer_pass) {
    case LayerPass::Layered: return ShaderId::ShadowLayered;
    case LayerPass::Geometry: return ShaderId::ShadowGeometry;
    default: return ShaderId::Shadow;
  }
}

draw::ShadingGroup &caster_group(gpu::Device &device, StorageList &stl, draw::Pass &pass, CasterFaces faces,
                                 bool is_double_sided, bool is_mirrored)
{
  const bool is_culled = faces != CasterFaces::All && !is_double_sided;
  Groups &groups = is_culled ? stl.shadow_cull : stl.shadow;
  // Without culling the winding makes no difference.
  draw::ShadingGroup *&group = is_culled && is_mirrored ? groups.mirrored : groups.straight;
  if (!group) {
    group = &pass.group(stl.shaders.get(device, shadow_shader(stl.shadows.layer_pass())));
    group->bind_storage_ref("object_block", &stl.object_block);
    group->bind_uniform_ref("shadow_render_block", stl.shadows.render_block());
    if (is_culled) {
      group->state_enable(faces == CasterFaces::Front ? State::CullBack : State::CullFront);
      group->state_enable(is_mirrored ? State::FrontClockwise : State::None);
    }
  }
  return *group;
}

/** What makes a caster's shadow, as plain numbers. */
std::uint64_t caster_fingerprint(const draw::ObjectRef &object, std::uint32_t mesh, std::uint64_t revision)
{
  struct {
    glm::mat4 world_from_object;
    std::uint64_t mesh;
    std::uint64_t revision;
  } const key = {object.world_from_object, mesh, revision};
  return fingerprint_of(std::as_bytes(std::span(&key, 1)));
}

void bind_lit(draw::ShadingGroup &group, StorageList &stl)
{
  group.bind_uniform("view_block", stl.view_block);
  group.bind_storage_ref("object_block", &stl.object_block);
  group.bind_storage("material_block", stl.material_block);
  group.bind_uniform("light_block", stl.light_block);
  group.bind_uniform("shadow_block", stl.shadows.block());
  if (has(stl.features, Feature::ShadowCube)) {
    group.bind_texture_ref("shadow_cubes", stl.shadows.cubes_binding());
  }
  if (has(stl.features, Feature::ShadowMap)) {
    group.bind_texture_ref("shadow_maps", stl.shadows.maps_binding());
  }
}

}  // namespace

void Engine::init(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  gpu::Device &device = viewport.device();
  auto &[fbl, txl, psl, stl, timing, samples_drawn] = data;
  if (!txl.radiance) {
    txl.radiance = picture(device, "radiance", gpu::Format::RGBA32F, viewport.size_px());
    fbl.depth_fb = device.create_framebuffer({.name = "depth_fb", .colors = {}, .depth = {&viewport.depth_texture()}});
    fbl.main_fb = device.create_framebuffer(
        {.name = "main_fb", .colors = {{&txl.radiance}}, .depth = {&viewport.depth_texture()}});
    stl.view_block = device.create_buffer({"view_block", gpu::BufferKind::Uniform, sizeof(shared::ViewData)});
    txl.nearest = device.create_sampler({.name = "nearest"});
    txl.film = picture(device, "film", gpu::Format::RGBA32F, viewport.size_px());
    fbl.film_fb = device.create_framebuffer({.name = "film_fb", .colors = {{&txl.film}}, .depth = {}});
  }
  if (settings_.has_display && !txl.display) {
    txl.display = picture(device, "display", gpu::Format::RGBA8, viewport.size_px());
    fbl.display_fb = device.create_framebuffer({.name = "display_fb", .colors = {{&txl.display}}, .depth = {}});
  }
}

void Engine::cache_init(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  gpu::Device &device = viewport.device();
  StorageList &stl = data.stl;
  data.psl = std::make_unique<PassList>(viewport.objects());
  data.samples_drawn = 0;
  stl.depth = stl.depth_cull = stl.lit = stl.lit_cull = stl.shadow = stl.shadow_cull = {};
  stl.caster_calls.assign(scene_.meshes.size(), {});
  stl.shaders.set_pcf(settings_.shadow.pcf);
  stl.batches.clear();
  stl.batches.resize(scene_.meshes.size());

  stl.lamps = make_lamps(scene_);
  stl.shadows.sync(device, scene_, stl.lamps, settings_.shadow);
  const std::vector<shared::MaterialData> materials = make_materials(scene_);
  stl.features = stl.lamps.features | stl.shadows.features();
  if (has(stl.features, Feature::Light)) {
    stl.features = stl.features | material_features(materials);
    if (!stl.light_block) {
      stl.light_block = device.create_buffer({"light_block", gpu::BufferKind::Uniform, sizeof(shared::LightBlock)});
    }
    device.update(stl.light_block, stl.lamps.light_block);
  }
  if (!materials.empty()) {
    const auto bytes = std::as_bytes(std::span(materials));
    if (!stl.material_block || stl.material_block.size_bytes() != bytes.size()) {
      stl.material_block = device.create_buffer({"material_block", gpu::BufferKind::Storage, bytes.size()});
    }
    device.update(stl.material_block, 0, bytes);
  }

  stl.film_weight_sum = film_weight_sum(settings_.sample_count, settings_.seed);
  draw::ShadingGroup &film = data.psl->film_pass.group(stl.shaders.get(device, ShaderId::Film));
  film.bind_texture("radiance_texture", data.txl.radiance, data.txl.nearest);
  film.constant_ref("column_weights", &stl.film_columns);
  film.constant_ref("row_weights", &stl.film_rows);
  film.call_procedural();
  if (settings_.has_display) {
    draw::ShadingGroup &tonemap = data.psl->tonemap.group(stl.shaders.get(device, ShaderId::Tonemap));
    tonemap.bind_texture("radiance_texture", data.txl.film, data.txl.nearest);
    tonemap.constant("view_transform", int(settings_.view_transform));
    tonemap.constant("exposure_scale", std::exp2(settings_.exposure));
    tonemap.call_procedural();
  }
}

void Engine::cache_populate(draw::Viewport &viewport, const draw::ObjectRef &object)
{
  Data &data = viewport.engine_data<Data>(*this);
  StorageList &stl = data.stl;
  gpu::Device &device = viewport.device();
  const scene::Mesh &mesh = scene_.meshes[scene_.objects[object.index].mesh];
  const scene::Material &material = scene_.materials[mesh.material];
  const gpu::Batch &batch = batch_of(device, stl, scene_, scene_.objects[object.index].mesh);
  const draw::ObjectIndex index = viewport.objects().add(object.world_from_object, mesh.material);
  const bool is_mirrored = draw::is_mirrored(object.world_from_object);

  const auto call = [&](Groups &groups, draw::Pass &pass, const gpu::Shader &shader, State state) {
    draw::ShadingGroup *&group = is_mirrored ? groups.mirrored : groups.straight;
    if (!group) {
      group = &pass.group(shader);
      bind_lit(*group, stl);
      group->state_enable(state);
      if (is_mirrored) {
        group->state_enable(State::FrontClockwise);
      }
    }
    group->call(batch, index, object.volume);
  };
  const gpu::Shader &depth_shader = stl.shaders.get(device, ShaderId::Depth);
  const gpu::Shader &lit_shader = stl.shaders.get(device, ShaderId::Lit, stl.features);
  if (material.is_double_sided) {
    call(stl.depth, data.psl->depth_pass, depth_shader, State::None);
    call(stl.lit, data.psl->pass, lit_shader, State::None);
  }
  else {
    call(stl.depth_cull, data.psl->depth_pass_cull, depth_shader, State::None);
    // At the same depth as the front of another face, the back must not be drawn over it.
    call(stl.lit_cull, data.psl->pass, lit_shader, State::CullBack);
  }

  if (has(stl.features, Feature::ShadowCube | Feature::ShadowMap)) {
    draw::InstanceCall *&instances = stl.caster_calls[scene_.objects[object.index].mesh][is_mirrored ? 1 : 0];
    if (!instances) {
      instances = &caster_group(device, stl, data.psl->shadow_pass, settings_.shadow.caster_faces,
                                material.is_double_sided, is_mirrored)
                       .instances(batch);
    }
    stl.shadows.add_caster({scene::transformed(mesh.bounds, object.world_from_object), index, instances,
                            caster_fingerprint(object, scene_.objects[object.index].mesh, mesh.revision)});
  }
}

void Engine::cache_finish(draw::Viewport &viewport)
{
  viewport.engine_data<Data>(*this).stl.shadows.finish();
}

void Engine::draw_scene(draw::Viewport &viewport, const draw::View &view)
{
  Data &data = viewport.engine_data<Data>(*this);
  auto &[fbl, txl, psl, stl, timing, samples_drawn] = data;
  gpu::Device &device = viewport.device();
  const glm::vec2 offset_px = film_offset_px(samples_drawn, settings_.sample_count, settings_.seed);
  const draw::View sample_view = with_sample_offset(view, offset_px, viewport.size_px());
  stl.object_block = {viewport.objects().buffer().id()};
  device.update(stl.view_block, view_data(sample_view));

  gpu::CommandList list;
  const auto submit_step = [&](const char *name) {
    if (!list.commands().empty()) {
      timed(settings_.is_timed, device, timing, name, [&] { device.submit(list); });
    }
    list.clear();
  };

  const float pixel_size = 2.0F / (view.clip_from_view()[1][1] * float(viewport.size_px().y));
  stl.shadows.update(device, view, pixel_size, psl->shadow_pass, list);
  submit_step("shadows");

  list.begin_pass("depth_prepass", fbl.depth_fb, {});
  psl->depth_pass.record(sample_view, list);
  psl->depth_pass_cull.record(sample_view, list);
  list.end_pass();
  submit_step("depth_prepass");

  list.begin_pass("lit", fbl.main_fb, {.depth_load = gpu::LoadAction::Load});
  psl->pass.record(sample_view, list);
  list.end_pass();
  submit_step("lit");

  const FilmWeights weights = film_weights(samples_drawn, settings_.sample_count, settings_.seed, stl.film_weight_sum);
  stl.film_columns = glm::vec4(weights.columns, 0.0F);
  stl.film_rows = glm::vec4(weights.rows, 0.0F);
  const bool is_first = samples_drawn == 0;
  list.begin_pass("film", fbl.film_fb, {.color_load = is_first ? gpu::LoadAction::Clear : gpu::LoadAction::Load});
  psl->film_pass.record(sample_view, list);
  list.end_pass();
  submit_step("film");

  samples_drawn = (samples_drawn + 1) % settings_.sample_count;
  if (!psl->tonemap.is_empty() && samples_drawn == 0) {
    list.begin_pass("tonemap", fbl.display_fb, {.color_load = gpu::LoadAction::DontCare});
    psl->tonemap.record(sample_view, list);
    list.end_pass();
    submit_step("tonemap");
  }
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
      step.seconds += viewport.device().elapsed_seconds(step.query).value_or(0.0);
      times.push_back({step.name, step.seconds});
    }
    step.seconds = 0.0;
  }
  return times;
}

std::vector<std::string> Engine::reload_shaders(draw::Viewport &viewport, gpu::ShaderFiles files) const
{
  return viewport.engine_data<Data>(*this).stl.shaders.reload(viewport.device(), std::move(files));
}

std::string Engine::serialize_passes(draw::Viewport &viewport) const
{
  const Data &data = viewport.engine_data<Data>(*this);
  std::string text;
  for (const draw::Pass *pass : {&data.psl->shadow_pass, &data.psl->depth_pass, &data.psl->depth_pass_cull,
                                 &data.psl->pass, &data.psl->film_pass, &data.psl->tonemap}) {
    text += pass->serialize(viewport.device());
  }
  return text;
}

Report Engine::report(draw::Viewport &viewport) const
{
  const Data &data = viewport.engine_data<Data>(*this);
  const StorageList &stl = data.stl;
  Report report;
  report.warnings = stl.lamps.warnings;
  report.limits = stl.lamps.limits;
  report.limits.insert(report.limits.end(), stl.shadows.limits().begin(), stl.shadows.limits().end());
  report.shadow_counters = stl.shadows.counters();

  const auto part = [&](std::string what, bool is_made, std::string why, std::string why_not) {
    report.parts.push_back({std::move(what), is_made, is_made ? std::move(why) : std::move(why_not)});
  };
  const Feature f = stl.features;
  const std::string no_shadow = settings_.shadow.method == ShadowMethod::None ? "shadows are off" : "no such lamp";
  part("light_block", has(f, Feature::Light), fmt::format("{} lights", stl.lamps.light_block.light_count),
       "no lamp gives light");
  part("shadow_cubes", has(f, Feature::ShadowCube),
       fmt::format("{} point lamps or wide spots", stl.shadows.cube_count()), no_shadow);
  part("shadow_maps", has(f, Feature::ShadowMap), fmt::format("{} suns or spots", stl.shadows.map_count()), no_shadow);
  part("shadow_pass", !data.psl->shadow_pass.is_empty(), "casters for the lamps' shadows",
       has(f, Feature::ShadowCube | Feature::ShadowMap) ? "no caster" : "no shadow");
  part("depth_pass", !data.psl->depth_pass.is_empty(), "two-sided materials", "no object with a two-sided material");
  part("depth_pass_cull", !data.psl->depth_pass_cull.is_empty(), "one-sided materials",
       "no object with a one-sided material");
  part("specular in eevee_lit", has(f, Feature::Specular), "a material reflects",
       has(f, Feature::Light) ? "every material is Lambertian" : "no lamp gives light");
  part("film", true, fmt::format("{} samples a pixel", settings_.sample_count), "");
  part("tonemap", bool(data.txl.display), "a display picture was asked for", "only radiance was asked for");
  part("programs", stl.shaders.size() > 0, fmt::format("{} programs", stl.shaders.size()), "nothing to draw");
  return report;
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
