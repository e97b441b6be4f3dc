// SPDX-License-Identifier: MIT
// Creates the resources of a frame and records its passes. Unchanged resources and passes are kept from the last sync.
#include "eevee_engine.hh"
#include "eevee_engine_data.hh"

#include "draw_view_shared.h"
#include "eevee_material_variants.hh"
#include "eevee_multiscatter_shared.h"
#include "eevee_shape_shared.h"
#include "eevee_surface_functions.hh"
#include "eevee_tables.hh"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gnomon::eevee {

using render_scene::MaterialClass;

void bind_lit(draw::ShadingGroup &group, Data &data)
{
  StorageList &stl = data.stl;
  group.bind_uniform("view_block", stl.view_block);
  group.bind_storage_ref("material_block", &stl.material_block);
  group.bind_storage_ref("full_material_block", &stl.full_material_block);
  group.bind_storage_ref("layer_block", &stl.layer_block);
  bind_lights(group, data);
  const WorldResources &world = data.shared->world;
  if (world.block) {
    group.bind_uniform("world_block", world.block);
  }
  if (world.levels) {
    group.bind_texture("world_levels", world.levels, world.sampler);
  }
  if (data.shared->ltc_table) {
    group.bind_texture("ltc_table", data.shared->ltc_table, data.shared->table_sampler);
  }
  if (data.shared->multiscatter_table) {
    group.bind_texture("multiscatter_table", data.shared->multiscatter_table, data.shared->table_sampler);
  }
  if (data.shared->surface_function_block) {
    group.bind_uniform("surface_function_block", data.shared->surface_function_block);
  }
  if (data.txl.behind) {
    group.bind_texture("behind", data.txl.behind, data.txl.behind_sampler);
  }
  stl.shadows->bind(group);
}

/** Create the targets of a picture with a visible object or a background. */
void Engine::make_targets(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  gpu::Device &device = viewport.device();
  FramebufferList &fbl = data.fbl;
  TextureList &txl = data.txl;
  StorageList &stl = data.stl;
  if (!txl.radiance) {
    txl.radiance = create_target(device, "radiance", gpu::Format::RGBA32F, viewport.drawn_size_px());
    fbl.depth_fb = device.create_framebuffer({.name = "depth_fb", .colors = {}, .depth = {&viewport.depth_texture()}});
    fbl.main_fb = device.create_framebuffer(
        {.name = "main_fb", .colors = {{&txl.radiance}}, .depth = {&viewport.depth_texture()}});
    stl.view_block = device.create_buffer({"view_block", gpu::BufferKind::Uniform, sizeof(shared::ViewData)});
    txl.nearest = device.create_sampler({.name = "nearest"});
  }
  if (stl.transmissive.empty()) {
    txl.behind = {};
  }
  else if (data.is_transmission_seen || txl.behind) {
    make_behind(data, viewport);
  }
  if (settings_.has_probe && !txl.probe_position) {
    txl.probe_position = create_target(device, "probe_position", gpu::Format::RGBA32F, viewport.drawn_size_px());
    txl.probe_normal = create_target(device, "probe_normal", gpu::Format::RGBA32F, viewport.drawn_size_px());
    fbl.probe_fb = device.create_framebuffer({.name = "probe_fb",
                                              .colors = {{&txl.probe_position}, {&txl.probe_normal}},
                                              .depth = {&viewport.depth_texture()}});
  }
  if (settings_.has_surfaces && !txl.surface_position) {
    txl.surface_position = create_target(device, "surface_position", gpu::Format::RGBA32F, viewport.drawn_size_px());
    txl.surface_normal = create_target(device, "surface_normal", gpu::Format::RGBA32F, viewport.drawn_size_px());
    txl.surface_albedo = create_target(device, "surface_albedo", gpu::Format::RGBA32F, viewport.drawn_size_px());
    fbl.surfaces_fb =
        device.create_framebuffer({.name = "surfaces_fb",
                                   .colors = {{&txl.surface_position}, {&txl.surface_normal}, {&txl.surface_albedo}},
                                   .depth = {&viewport.depth_texture()}});
  }
}

void Engine::sync_materials(StorageList &stl) const
{
  const std::uint64_t materials =
      scene_.materials_revision() + scene_.passes_revision() + scene_.objects().structure_revision();
  if (stl.materials_features_revision == materials) {
    return;
  }
  stl.material_features = Feature::None;
  stl.alpha_min = 1.0F;
  stl.widest_class = MaterialClass::Plain;
  stl.transmissive.clear();
  stl.is_transmission_rough = false;
  stl.has_surface_functions = false;
  const scene::Scene &scene = scene_.scene();
  std::vector<std::optional<MaterialClass>> classes(scene.meshes().index_end());
  for (const draw::ObjectIndex object : stl.objects) {
    const scene::Handle<scene::Mesh> handle = scene_.object(object).mesh;
    std::optional<MaterialClass> &material_class = classes[handle.index];
    if (material_class && *material_class != MaterialClass::Transmissive) {
      continue;
    }
    const scene::Mesh &mesh = scene.meshes()[handle];
    material_class = render_scene::material_class(scene, mesh);
    const std::uint32_t place = render_scene::MaterialTable::place_of(scene, mesh.material);
    const bool has_function = render_scene::has_surface_function(scene, scene.material_of(mesh));
    stl.has_surface_functions |= has_function;
    const bool is_specular =
        scene_.materials()[place].specular_f90 > 0.0F || *material_class >= MaterialClass::Layered || has_function;
    stl.material_features =
        stl.material_features | (is_specular ? Feature::Specular : Feature::None) | feature_of(*material_class);
    if (is_specular) {
      // Textures and functions may make any lobe.
      const bool is_uniform = *material_class == MaterialClass::Plain && !has_function;
      stl.alpha_min = std::min(stl.alpha_min, is_uniform ? scene_.materials()[place].alpha : 0.0F);
    }
    stl.widest_class = std::max(stl.widest_class, *material_class);
    if (*material_class == MaterialClass::Transmissive) {
      stl.transmissive.push_back({object, render_scene::is_blended(scene, mesh)});
      stl.is_transmission_rough |= has_function || scene.material_of(mesh).roughness > 0.0F;
    }
  }
  stl.materials_features_revision = materials;
}

/** Create the tables of the specular lobe. \a features: of the frame. \a read: what programs read. */
static void make_tables(SharedData &shared, gpu::Device &device, Feature features, Feature read)
{
  const auto update = [&](gpu::Texture &table, const char *name, bool is_needed, glm::ivec2 size,
                          std::span<const float> (*texels)()) {
    if (!is_needed) {
      table = {};
    }
    else if (!table) {
      table = create_target(device, name, gpu::Format::RGBA32F, size);
      device.upload(table, 0, std::as_bytes(texels()));
    }
  };
  // With multiple scattering, the world's light reads its table of albedos.
  const bool has_multiscatter = has(read, Feature::Multiscatter);
  const Feature of_ltc = has_multiscatter ? Feature::LampShape : Feature::LampShape | Feature::World;
  const bool has_ltc = has(read, Feature::Layers) || (has(features, of_ltc) && has(features, Feature::Specular));
  update(shared.ltc_table, "ltc_table", has_ltc, {2 * LTC_TABLE_SIZE, LTC_TABLE_SIZE}, ltc_table);
  update(shared.multiscatter_table, "multiscatter_table", has_multiscatter, glm::ivec2(MULTISCATTER_TABLE_SIZE),
         multiscatter_table);
  if ((has_ltc || has_multiscatter) && !shared.table_sampler) {
    shared.table_sampler = device.create_sampler({.name = "table_sampler", .filter = gpu::Filter::Linear});
  }
}

void Engine::make_blocks(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  StorageList &stl = data.stl;
  SharedData &shared = *data.shared;
  gpu::Device &device = viewport.device();
  sync_materials(stl);
  scene_.upload(stl.widest_class);
  if (settings_.light.has(LightPart::Kind::Emission)) {
    shared.materials_without_emission.reset();
  }
  else {
    using render_scene::MaterialTable;
    MaterialTable &dark = shared.materials_without_emission
                              ? *shared.materials_without_emission
                              : shared.materials_without_emission.emplace(MaterialTable::Emission::LeftOut);
    dark.update(scene_.scene());
    dark.upload(device, stl.widest_class);
  }
  update_surface_functions(
      shared.surface_function_block, device, stl.has_surface_functions,
      {glm::vec3(scene_.origin_ws()), settings_.light.has(LightPart::Kind::Emission) ? 1.0F : 0.0F});
  update_world_picture(shared.world, device, scene_, settings_);
  if (has(stl.features, Feature::Light)) {
    const Feature specular = stl.material_features & Feature::Specular;
    stl.features = with_variant(
        shared.lamps.features | shared.shadows.features() | specular | asked_features() |
        (stl.alpha_min < shared.lamps.highlight_alpha ? Feature::LampShape | Feature::LampHighlights : Feature::None));
  }
  // The inputs of the programs of some materials, beyond those of the frame. They are the same for all viewports, as
  // they share the blocks.
  const Feature read =
      with_variant(stl.features | (stl.material_features & (Feature::Layers | Feature::Transmission)) |
                   (stl.has_surface_functions ? lit_function_features : Feature::None) | asked_features());
  make_lights(data, device, settings_, read);
  if (!has(read, Feature::Light)) {
    shared.ltc_table = {};
    shared.multiscatter_table = {};
    shared.world.block = {};
    shared.world.levels = {};
    return;
  }
  update_world(shared.world, device, scene_, stl.features, settings_);
  make_tables(shared, device, stl.features, read);
}

void Engine::record_background(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  StorageList &stl = data.stl;
  const WorldResources &world = data.shared->world;
  const bool is_picture = bool(world.picture);
  draw::ShadingGroup &group = data.psl->background_pass.group(
      shaders_->get(viewport.device(), is_picture ? ShaderId::BackgroundWorld : ShaderId::BackgroundColor));
  group.constant("color", glm::vec4(background_color(settings_, scene_), 0.0F));
  if (is_picture) {
    group.bind_texture("world_picture", world.picture, world.picture_sampler);
    group.constant_ref("corner", &stl.background_corner);
    group.constant_ref("across", &stl.background_across);
    group.constant_ref("up", &stl.background_up);
    group.constant("turn", scene_.scene().world()->rotation / (2.0F * std::numbers::pi_v<float>));
  }
  group.call_procedural();
}

void Engine::record_film(draw::Viewport &viewport, draw::Pass &pass)
{
  Data &data = viewport.engine_data<Data>(*this);
  StorageList &stl = data.stl;
  draw::ShadingGroup &film = pass.group(shaders_->get(viewport.device(), ShaderId::Film));
  film.bind_texture("radiance_texture", data.txl.radiance, data.txl.nearest);
  film.constant("radiance_origin_px", viewport.guard_px());
  film.constant_ref("column_weights", &stl.film_columns);
  film.constant_ref("row_weights", &stl.film_rows);
  film.call_procedural();
}

/** Record the tonemap pass for the current target. */
void Engine::record_tonemap(draw::Viewport &viewport, const draw::View &view)
{
  Data &data = viewport.engine_data<Data>(*this);
  StorageList &stl = data.stl;
  TextureList &txl = data.txl;
  gpu::Device &device = viewport.device();
  const draw::Target &target = data.target;
  const bool has_own_depth = target.depth && settings_.sample_count != 1;
  if (has_own_depth && !txl.picture_depth) {
    txl.picture_depth = create_target(device, "picture_depth", gpu::Format::Depth32F, viewport.drawn_size_px());
    data.fbl.picture_depth_fb =
        device.create_framebuffer({.name = "picture_depth_fb", .colors = {}, .depth = {&txl.picture_depth}});
  }
  const gpu::Texture &depth_texture = has_own_depth ? txl.picture_depth : viewport.depth_texture();
  const Feature features = target.depth ? Feature::TargetDepth : Feature::None;
  stl.target_pass.set(data.psl->tonemap, target,
                      {.radiance = txl.film,
                       .size_px = viewport.size_px(),
                       .scale = sample_scale(data, data.film_sample_count),
                       .depth = &depth_texture,
                       .depth_origin_px = viewport.guard_px(),
                       .clip_from_view = view.clip_from_view(),
                       .has_blended = !stl.blended.empty()},
                      shaders_->get(device, ShaderId::Tonemap, features), txl.nearest);
}

void Engine::record(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  if (data.is_recorded && (data.txl.behind || !data.is_transmission_seen)) {
    return;
  }
  // If an exception ends the recording, the incomplete passes must not be drawn.
  data.is_synced = false;
  StorageList &stl = data.stl;
  SharedData &shared = *data.shared;
  make_targets(viewport);
  make_adaptive(viewport);
  make_blocks(viewport);
  if (!shared.has_casters) {
    shared.shadows.allocate(viewport.device(), *shaders_);
  }
  stl.shadows->allocate(viewport.device());
  const PassesKey key{
      .structure = scene_.objects().structure_revision(),
      .passes = scene_.passes_revision(),
      .settings = settings_revision_,
      .shaders = shaders_->revision(),
      .exponential_lamps =
          has(stl.features, Feature::ShadowEsm) ? scene_.lamps_revision() + shared.shadows.viewports_revision() : 0,
      .shadow_block = stl.shadows->block().id(),
      .light_block = shared.light_block.id(),
      .light_shape_block = shared.light_shape_block.id(),
      .light_texture = shared.light_texture.id(),
      .light_cluster_block = stl.clusters.block.id(),
      .ltc_table = shared.ltc_table.id(),
      .multiscatter_table = shared.multiscatter_table.id(),
      .world_block = shared.world.block.id(),
      .world_levels = shared.world.levels.id(),
      .world_picture = shared.world.picture.id(),
      .behind = data.txl.behind.id(),
      .surface_function_block = shared.surface_function_block.id(),
      .film_converged = data.adaptive.film_converged.id(),
      .world = has_background(settings_, scene_) ? scene_.scene().world_revision() : 0,
      .features = stl.features,
      .tinted_light = shared.tinted_light,
  };
  if (stl.recorded != key || std::exchange(stl.is_winding_changed, false)) {
    stl.recorded.reset();
    record_passes(viewport);
    stl.recorded = key;
  }
  if (!shared.has_casters) {
    record_casters(data);
    add_casters(data);
  }
  data.is_synced = data.is_recorded = true;
}

void Engine::record_passes(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  StorageList &stl = data.stl;
  data.psl = std::make_unique<PassList>(scene_.objects());
  free_surface_functions(*shaders_, scene_.scene());
  stl.pass_recordings++;
  stl.target_pass.reset();
  stl.groups.clear();
  stl.blended.clear();
  stl.blended_group_count = 0;
  stl.is_deferred = is_scene_deferred(stl.features);
  record_objects(viewport);
  if (!data.psl->gbuffer_pass.is_empty()) {
    record_deferred_lit(viewport);
  }
  if (has_background(settings_, scene_)) {
    record_background(viewport);
  }
  record_film(viewport, data.psl->film_pass);
  if (data.adaptive.film_converged) {
    record_film(viewport, data.psl->film_sampled_pass);
    record_adaptive(viewport);
  }
}

}  // namespace gnomon::eevee
