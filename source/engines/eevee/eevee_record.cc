// SPDX-License-Identifier: MIT
// Creates the resources of a frame and records its passes. Unchanged resources and passes of objects are kept.
#include "eevee_engine.hh"
#include "internal/eevee_engine_data.hh"

#include "internal/eevee_surface_functions.hh"

namespace gnomon::eevee {

void Engine::make_blocks(draw::Viewport &viewport)
{
  Data &data = data_of(viewport);
  SharedData &shared = *data.shared;
  gpu::Device &device = viewport.device();
  DrawnMaterials &materials = data.materials;
  shared.materials.make(scene_, settings_, materials);
  shared.world.update_picture(scene_, settings_);
  if (has(data.features, Feature::Light)) {
    const Feature specular = materials.features & Feature::Specular;
    data.features = with_variant(
        shared.lights.plan().lamps.features | shared.shadows.features() | specular | asked_features(settings_) |
        (materials.alpha_min < shared.lights.plan().lamps.highlight_alpha ? Feature::LampShape | Feature::LampHighlights
                                                                          : Feature::None) |
        (settings_.planned_sample_count() == 1 && has_world_occlusion(settings_, scene_) ? Feature::WorldOcclusion
                                                                                         : Feature::None));
  }
  // The inputs of the programs of some materials, beyond those of the frame. They are the same for all viewports, as
  // they share the blocks.
  const Feature read =
      with_variant(data.features | (materials.features & (Feature::Layers | Feature::Transmission)) |
                   (materials.has_functions ? lit_function_features : Feature::None) | asked_features(settings_));
  shared.lights.make(device, settings_, read);
  data.lights.make(device);
  shared.world.update_light(scene_, data.features, settings_,
                            shared.lights.plan().points.rest_directions(settings_.seed));
  shared.tables.make(device, data.features, read);
}

void Engine::record(draw::Viewport &viewport)
{
  Data &data = data_of(viewport);
  if (data.is_recorded && (data.transmission.behind() || !data.is_transmission_seen)) {
    return;
  }
  // If an exception ends the recording, the incomplete passes must not be drawn.
  data.is_synced = false;
  SharedData &shared = *data.shared;
  data.buffers.make(viewport);
  data.materials.update(scene_, data.surfaces.objects());
  if (data.materials.transmissive.empty()) {
    data.transmission.free();
  }
  else if (data.is_transmission_seen || data.transmission.behind()) {
    data.transmission.make(viewport, data.materials.is_transmission_rough);
  }
  data.probe.make(viewport, settings_);
  data.adaptive.make(data.state(settings_), viewport);
  make_blocks(viewport);
  data.transmission.update(scene_, data.materials.transmissive, settings_, shared.world);
  if (!shared.shadow_pass.has_casters()) {
    shared.shadows.allocate(viewport.device(), *shaders_);
  }
  data.shadows.allocate(viewport.device());
  record_passes(viewport);
  shared.shadow_pass.update(scene_, *shaders_, settings_, settings_revision_, data.features, data.surfaces.objects());
  data.is_synced = data.is_recorded = true;
}

void Engine::record_passes(draw::Viewport &viewport)
{
  Data &data = data_of(viewport);
  gpu::Device &device = viewport.device();
  const std::optional<int> tinted = data.shared->lights.plan().tinted;
  const Feature features = data.features | asked_features(settings_);
  const BindLit bind = [&](draw::ShadingGroup &group) { data.bind_lit(group); };
  // Passes of one call are recorded each time: that takes no longer than a test of their inputs.
  data.output.clear();
  data.background.record(*shaders_, scene_, settings_);
  data.film.record(shaders_->get(device, ShaderId::Film), data.buffers.radiance, viewport.guard_px(),
                   data.buffers.nearest);
  data.adaptive.record(device, *shaders_, settings_, viewport.guard_px());
  if (!data.frame.is_current(device) || !data.probe.is_current(device)) {
    data.surfaces.forget();
  }
  data.surfaces.update(
      scene_, *shaders_,
      {.scene = scene_.passes_revision(),
       .shaders = shaders_->revision(),
       .pcf = settings_.shadow.pcf,
       .features = features,
       .tinted_entry = tinted ? std::optional(data.shared->lights.entry_of(*tinted, tinted_entry)) : std::nullopt,
       .has_probe = settings_.has_probe,
       .has_surfaces = settings_.has_surfaces,
       .has_behind = bool(data.transmission.behind()),
       .is_clipped = data.is_clipped},
      bind);
  data.depth.record_lighting(device, *shaders_, with_variant(features), bind);
}

}  // namespace gnomon::eevee
