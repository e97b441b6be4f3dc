// SPDX-License-Identifier: MIT
// Creates what a frame draws with, and records its passes: each as far as it changed since the last sync.
#include "eevee_engine.hh"
#include "eevee_engine_data.hh"

#include "draw_view_shared.h"

#include <algorithm>
#include <cmath>

namespace gnomon::eevee {

namespace {

using gpu::State;

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

/** What a caster's shadow depends on, as plain numbers. */
std::uint64_t caster_fingerprint(const scene::Scene &scene, const render_scene::RenderObject &object,
                                 const glm::mat4 &world_from_object)
{
  const scene::Mesh &mesh = scene.meshes()[object.mesh];
  const scene::Material &material = scene.material_of(mesh);
  struct {
    glm::mat4 world_from_object;
    std::uint64_t mesh;
    scene::Revision shape;
    std::uint64_t is_double_sided;
    std::uint64_t texture;
    scene::Revision image_of_texture;
    scene::Revision sampler;
    scene::Revision content;
    float alpha;
    float alpha_cutoff;
  } key{};
  key.world_from_object = world_from_object;
  key.mesh = object.mesh.key();
  key.shape = scene.meshes().revision(object.mesh, scene::Mesh::Aspect::Shape);
  key.is_double_sided = material.is_double_sided ? 1 : 0;
  if (render_scene::is_textured(scene, mesh) && render_scene::is_masked(scene, material)) {
    const scene::Handle<scene::Texture> texture = material.base_color_texture;
    key.texture = texture.key();
    key.image_of_texture = scene.textures().revision(texture, scene::Texture::Aspect::Image);
    key.sampler = scene.textures().revision(texture, scene::Texture::Aspect::Sampler);
    key.content = scene.images().revision(scene.textures()[texture].image, scene::Image::Aspect::Content);
    key.alpha = material.alpha;
    key.alpha_cutoff = material.alpha_cutoff;
  }
  return fingerprint_of(std::as_bytes(std::span(&key, 1)));
}

void bind_lit(draw::ShadingGroup &group, StorageList &stl)
{
  group.bind_uniform("view_block", stl.view_block);
  group.bind_storage_ref("object_block", &stl.object_block);
  group.bind_storage_ref("material_block", &stl.material_block);
  group.bind_uniform("light_block", stl.light_block);
  stl.shadows.bind(group);
}

}  // namespace

/** The targets of a picture in which any object is visible. */
void Engine::make_targets(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  gpu::Device &device = viewport.device();
  FramebufferList &fbl = data.fbl;
  TextureList &txl = data.txl;
  StorageList &stl = data.stl;
  if (!txl.radiance) {
    txl.radiance = create_target(device, "radiance", gpu::Format::RGBA32F, viewport.size_px());
    fbl.depth_fb = device.create_framebuffer({.name = "depth_fb", .colors = {}, .depth = {&viewport.depth_texture()}});
    fbl.main_fb = device.create_framebuffer(
        {.name = "main_fb", .colors = {{&txl.radiance}}, .depth = {&viewport.depth_texture()}});
    stl.view_block = device.create_buffer({"view_block", gpu::BufferKind::Uniform, sizeof(shared::ViewData)});
    txl.nearest = device.create_sampler({.name = "nearest"});
  }
  if (settings_.has_probe && !txl.probe_position) {
    txl.probe_position = create_target(device, "probe_position", gpu::Format::RGBA32F, viewport.size_px());
    txl.probe_normal = create_target(device, "probe_normal", gpu::Format::RGBA32F, viewport.size_px());
    fbl.probe_fb = device.create_framebuffer({.name = "probe_fb",
                                              .colors = {{&txl.probe_position}, {&txl.probe_normal}},
                                              .depth = {&viewport.depth_texture()}});
  }
}

void Engine::make_blocks(draw::Viewport &viewport)
{
  StorageList &stl = viewport.engine_data<Data>(*this).stl;
  gpu::Device &device = viewport.device();
  scene_.upload();
  if (!has(stl.features, Feature::Light)) {
    stl.light_block = {};
    return;
  }
  const std::uint64_t materials =
      scene_.materials_revision() + scene_.passes_revision() + scene_.objects().structure_revision();
  if (stl.materials_features_revision != materials) {
    const bool is_specular = std::ranges::any_of(stl.objects, [&](draw::ObjectIndex object) {
      const scene::Handle<scene::Material> material = scene_.scene().meshes()[scene_.object(object).mesh].material;
      const std::uint32_t place = render_scene::MaterialTable::place_of(scene_.scene(), material);
      return scene_.materials()[place].specular_f90 > 0.0F;
    });
    stl.material_features = is_specular ? Feature::Specular : Feature::None;
    stl.materials_features_revision = materials;
  }
  stl.features = stl.features | stl.material_features;
  if (!stl.light_block) {
    stl.light_block = device.create_buffer({"light_block", gpu::BufferKind::Uniform, sizeof(shared::LightBlock)});
    stl.is_light_block_written = false;
  }
  if (!std::exchange(stl.is_light_block_written, true)) {
    device.update(stl.light_block, stl.lamps.light_block);
  }
}

void Engine::record_film(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  StorageList &stl = data.stl;
  draw::ShadingGroup &film = data.psl->film_pass.group(shaders_.get(viewport.device(), ShaderId::Film));
  film.bind_texture("radiance_texture", data.txl.radiance, data.txl.nearest);
  film.constant_ref("column_weights", &stl.film_columns);
  film.constant_ref("row_weights", &stl.film_rows);
  film.call_procedural();
  if (settings_.has_display) {
    draw::ShadingGroup &tonemap = data.psl->tonemap.group(shaders_.get(viewport.device(), ShaderId::Tonemap));
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
  // Until it comes to its end: a part of it must not be drawn.
  data.is_synced = false;
  StorageList &stl = data.stl;
  make_targets(viewport);
  make_blocks(viewport);
  if (!stl.has_casters) {
    stl.shadows.allocate(viewport.device(), shaders_);
  }
  const PassesKey key{
      .structure = scene_.objects().structure_revision(),
      .passes = scene_.passes_revision(),
      .settings = settings_revision_,
      .shaders = shaders_revision_,
      .exponential_lamps = has(stl.features, Feature::ShadowEsm) ? scene_.lamps_revision() + 1 : 0,
      .shadow_block = stl.shadows.block().id(),
      .light_block = stl.light_block.id(),
      .features = stl.features,
      .tinted_light = stl.tinted_light,
  };
  if (stl.recorded != key || std::exchange(stl.is_winding_changed, false)) {
    stl.recorded.reset();
    record_passes(viewport);
    stl.recorded = key;
  }
  if (!stl.has_casters) {
    add_casters(data);
  }
  data.is_synced = data.is_recorded = true;
}

void Engine::record_passes(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  StorageList &stl = data.stl;
  data.psl = std::make_unique<PassList>(scene_.objects());
  stl.pass_recordings++;
  stl.groups.clear();
  stl.caster_calls.clear();
  stl.caster_of.assign(scene_.objects().index_end(), nullptr);
  stl.is_mirrored.assign(scene_.objects().index_end(), false);
  stl.has_casters = false;
  for (const draw::ObjectIndex object : stl.objects) {
    record_object(viewport, object);
    if (has(stl.features, any_shadow) && scene_.object(object).casts_shadow) {
      record_caster(data, object);
    }
  }
  record_film(viewport);
}

void Engine::record_object(draw::Viewport &viewport, draw::ObjectIndex index)
{
  Data &data = viewport.engine_data<Data>(*this);
  StorageList &stl = data.stl;
  gpu::Device &device = viewport.device();
  const scene::Scene &scene = scene_.scene();
  const render_scene::RenderObject &object = scene_.object(index);
  const scene::Mesh &mesh = scene.meshes()[object.mesh];
  const scene::Material &material = scene.material_of(mesh);
  const bool has_texture = render_scene::is_textured(scene, mesh);
  const bool has_mask = has_texture && render_scene::is_masked(scene, material);
  const bool is_lit_textured = has_texture && (has_mask || has(stl.features, Feature::Light));
  const gpu::Batch &batch = scene_.batch(object.mesh, is_lit_textured);
  stl.is_mirrored[index] = draw::is_mirrored(scene_.objects().world_from_object(index));
  const State winding = stl.is_mirrored[index] ? State::FrontClockwise : State::None;

  /** Appends a call to the group of a pass; \a bind fills in a new group. */
  const auto call = [&](draw::Pass &pass, const gpu::Shader &shader, State state, bool is_textured, const auto &bind) {
    const auto texture = is_textured ? material.base_color_texture : scene::Handle<scene::Texture>();
    draw::ShadingGroup *&group = stl.groups[{&pass, shader.id(), state | winding, texture}];
    if (!group) {
      group = &pass.group(shader);
      group->state_enable(state | winding);
      bind(*group);
      if (is_textured) {
        const auto [image, sampler] = scene_.texture(texture);
        group->bind_texture("base_color_texture", image, sampler);
      }
    }
    group->call(batch, index);
  };
  const auto bind_surface = [&stl](draw::ShadingGroup &group) { bind_lit(group, stl); };
  // A surface that receives no shadow is lit as if no lamp had one.
  const Feature lighting = object.receives_shadow ? stl.features : without_shadows(stl.features);
  const gpu::Shader &depth_shader =
      shaders_.get(device, ShaderId::Depth, has_mask ? Feature::AlphaMask : Feature::None);
  const gpu::Shader &lit_shader =
      shaders_.get(device, ShaderId::Lit, lighting | (is_lit_textured ? Feature::BaseColorTexture : Feature::None));
  call(material.is_double_sided ? data.psl->depth_pass : data.psl->depth_pass_cull, depth_shader, State::None, has_mask,
       bind_surface);
  // At the same depth as the front of another face, the back must not be drawn over it.
  const State side = material.is_double_sided ? State::None : State::CullBack;
  call(data.psl->lit_pass, lit_shader, side, is_lit_textured, bind_surface);
  if (stl.tinted_light) {
    call(data.psl->tint_pass, shaders_.get(device, ShaderId::DebugCascades, stl.features), side, false,
         [&stl](draw::ShadingGroup &group) {
           bind_lit(group, stl);
           group.constant("tinted_light", *stl.tinted_light);
         });
  }
  if (settings_.has_probe && has(stl.features, Feature::Light)) {
    call(data.psl->probe_pass, shaders_.get(device, ShaderId::Probe, stl.features), side, false,
         [&stl](draw::ShadingGroup &group) {
           bind_lit(group, stl);
           group.constant_ref("probed_light", &stl.probed_light);
         });
  }
}

void Engine::record_caster(Data &data, draw::ObjectIndex index)
{
  StorageList &stl = data.stl;
  const render_scene::RenderObject &object = scene_.object(index);
  const scene::Scene &scene = scene_.scene();
  const scene::Mesh &mesh = scene.meshes()[object.mesh];
  const scene::Material &material = scene.material_of(mesh);
  const bool has_mask = render_scene::is_textured(scene, mesh) && render_scene::is_masked(scene, material);
  const State winding = stl.is_mirrored[index] ? State::FrontClockwise : State::None;
  draw::InstanceCall *&instances = stl.caster_calls[{object.mesh, winding}];
  if (!instances) {
    const gpu::Shader &shader = shaders_.get(scene_.device(), shadow_shader(stl.shadows.layer_pass()),
                                             has_mask ? Feature::AlphaMask : Feature::None);
    const State faces = material.is_double_sided ? State::None : culled_state(settings_.shadow.caster_faces);
    // Without culling the winding makes no difference.
    const State state = faces == State::None ? State::None : faces | winding;
    const auto texture = has_mask ? material.base_color_texture : scene::Handle<scene::Texture>();
    draw::ShadingGroup *&group = stl.groups[{&data.psl->shadow_pass, shader.id(), state, texture}];
    if (!group) {
      group = &data.psl->shadow_pass.group(shader);
      group->state_enable(state);
      group->bind_storage_ref("object_block", &stl.object_block);
      group->bind_storage_ref("material_block", &stl.material_block);
      group->bind_uniform_ref("shadow_render_block", stl.shadows.render_block());
      if (has_mask) {
        const auto [image, sampler] = scene_.texture(texture);
        group->bind_texture("base_color_texture", image, sampler);
      }
    }
    instances = &group->instances(scene_.batch(object.mesh, has_mask));
  }
  stl.caster_of[index] = instances;
}

/** The casters as they stand, for the shadows to compare with those that they were drawn with. */
void Engine::add_casters(Data &data)
{
  StorageList &stl = data.stl;
  for (const draw::ObjectIndex index : stl.objects) {
    if (draw::InstanceCall *instances = stl.caster_of[index]) {
      const render_scene::RenderObject &object = scene_.object(index);
      const glm::mat4 &world_from_object = scene_.objects().world_from_object(index);
      stl.shadows.add_caster({object.bounds, index, instances,
                              caster_fingerprint(scene_.scene(), object, world_from_object),
                              &scene_.scene().meshes()[object.mesh], &world_from_object});
    }
  }
  stl.shadows.finish();
  stl.has_casters = true;
}

}  // namespace gnomon::eevee
