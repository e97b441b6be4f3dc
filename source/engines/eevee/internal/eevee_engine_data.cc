// SPDX-License-Identifier: MIT
#include "internal/eevee_engine_data.hh"

namespace gnomon::eevee {

static std::shared_ptr<SharedData> shared_of(render_scene::RenderScene &scene, std::weak_ptr<SharedData> &shared_data)
{
  std::shared_ptr<SharedData> shared = shared_data.lock();
  if (!shared) {
    shared = std::make_shared<SharedData>(scene.objects());
    shared_data = shared;
  }
  return shared;
}

/** The frame: all steps, in the order in which they are drawn. */
static std::vector<FrameStep> frame_steps(Data &data)
{
  std::vector<FramePass> all_depth_passes = data.depth.passes();
  all_depth_passes.push_back(data.transmission.depths());
  return {
      data.adaptive.depth_step(),
      // The depths come before the shadows because cascades may be fitted to them.
      data.depth.gbuffer_step(),
      data.depth.prepass_step(),
      data.lights.points_step(),
      data.lights.lists_step(),
      shadows_step(data.shadows, data.shared->shadow_pass, data.depth.feedback()),
      data.adaptive.background_step(),
      data.depth.lighting_step(),
      data.adaptive.forward_depth_step(),
      data.depth.forward_step(),
      data.surfaces.step(),
      data.background.step(),
      data.blend.behind_step(),
      data.transmission.copy_step(),
      data.transmission.step(),
      data.blend.step(),
      data.film.step(),
      data.adaptive.film_step(),
      data.adaptive.test_step(),
      data.adaptive.spread_step(),
      data.output.depth_step(std::move(all_depth_passes)),
      data.output.step(),
  };
}

Data::Data(render_scene::RenderScene &scene, std::weak_ptr<SharedData> &shared_data)
    : shared(shared_of(scene, shared_data)),
      lights(shared->lights),
      shadows(shared->shadows),
      depth(scene.objects(), buffers, shadows),
      background(shared->world, buffers),
      transmission(scene.objects(), buffers),
      blend(scene.objects(), buffers),
      probe(scene.objects(), buffers, depth, transmission),
      surfaces(scene.objects(), buffers, depth, transmission, blend, probe),
      frame(frame_steps(*this))
{
}

void Data::resized()
{
  adaptive.resized();
  film.resized();
  probe.resized();
  transmission.free();
  output.resized();
  buffers.resized();
  depth.feedback().forget();
  is_synced = false;
}

FrameState Data::state(const Settings &settings) const
{
  return {.settings = settings,
          .features = features,
          .is_seen = is_seen,
          .is_transmission_seen = is_transmission_seen,
          .has_transmission = !materials.transmissive.empty(),
          .has_tinted_light = shared->lights.plan().tinted.has_value(),
          .has_lamp_points = !shared->lights.plan().points.empty(),
          .has_blended_casters = shared->shadow_pass.has_blended(),
          .skips_converged = adaptive.is_active()};
}

void Data::bind_lit(draw::ShadingGroup &group) const
{
  group.bind_uniform("view_block", buffers.view_block);
  shared->materials.bind(group);
  shared->lights.bind(group);
  lights.bind(group);
  shared->world.bind(group);
  shared->tables.bind(group);
  transmission.bind(group);
  shadows.bind(group);
}

}  // namespace gnomon::eevee
