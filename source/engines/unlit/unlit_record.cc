// SPDX-License-Identifier: MIT
// Records the passes of a viewport's surfaces, and orders those that are blended.
#include "internal/unlit_engine_data.hh"

#include "render_blend_order.hh"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

namespace gnomon::unlit {

using gpu::State;
using render_scene::MaterialClass;

void Engine::record(Data &data, gpu::Device &device)
{
  const PassesKey key{.structure = scene_.objects().structure_revision(),
                      .passes = scene_.passes_revision(),
                      .settings = settings_revision_,
                      .losses = device.loss_count(),
                      .depth_texture = depth_camera_ ? depth_camera_->texture.id() : 0,
                      .is_clipped = data.is_clipped,
                      .display = data.display};
  if (data.recorded != key || std::exchange(data.is_winding_changed, false)) {
    data.recorded = {};
    record_surfaces(data, device);
    data.recorded = key;
  }
  scene_.upload(data.widest);
  data.blocks.update(scene_);
  if (depth_camera_) {
    depth_camera_->blocks.update(scene_);
    const draw::View &view = depth_camera_->view;
    data.depth_clip_from_world = view.clip_from_world();
    // A perspective depth is near / distance, and its rounding error is relative to the depth. The error of an
    // orthographic depth is relative to the depth range.
    const glm::vec2 rounding = view.is_perspective() ? glm::vec2(1e-5F, 0.0F) : glm::vec2(0.0F, 1e-6F);
    data.depth_tolerance = {rounding, std::exp2(-float(device.limits().subpixel_bits))};
  }
}

void Engine::record_surfaces(Data &data, gpu::Device &device)
{
  const scene::Scene &scene = scene_.scene();
  data.widest = MaterialClass::Plain;
  data.surfaces.emplace("unlit", State::WriteColor | State::WriteDepth | State::DepthNearerEqual, &scene_.objects());
  data.blended_surfaces.emplace("unlit blended", State::WriteColor | State::DepthNearerEqual | State::BlendOver,
                                &scene_.objects());
  data.blended.clear();
  data.is_mirrored.assign(scene_.objects().index_end(), false);
  std::uint32_t blended_group_count = 0;
  std::map<std::tuple<Feature, State, render_scene::TextureSet>, draw::ShadingGroup *> groups;
  for (const draw::ObjectIndex index : data.objects) {
    const render_scene::RenderObject &object = scene_.object(index);
    const scene::Mesh &mesh = scene.meshes()[object.mesh];
    const MaterialClass surface = std::min(render_scene::material_class(scene, mesh), MaterialClass::Full);
    data.widest = std::max(data.widest, surface);
    data.is_mirrored[index] = scene_.objects().is_mirrored(index);
    const bool is_receiver = depth_camera_ && object.receives_shadow;
    const Feature features = feature_of(surface) | (is_receiver ? Feature::DepthCamera : Feature::None) |
                             (data.is_clipped ? Feature::ClipPlanes : Feature::None) |
                             (data.display.is_xray ? Feature::XRay : Feature::None);
    const bool is_wireframe = data.display.is_wireframe && mesh.topology == scene::Topology::Triangles;
    const State fixed = (data.is_mirrored[index] ? State::FrontClockwise : State::None) |
                        render_scene::topology_state(mesh.topology) | (is_wireframe ? State::Wireframe : State::None);
    const bool is_double_sided = scene.material_of(mesh).is_double_sided;
    const State side = is_double_sided || is_wireframe ? State::None : State::CullBack;
    const render_scene::TextureSet textures = render_scene::textures_of(scene, mesh, surface);
    const gpu::Batch &batch = scene_.batch(object.mesh, render_scene::streams_of(surface));
    const auto make_group = [&](draw::Pass &pass, State state) -> draw::ShadingGroup & {
      draw::ShadingGroup &group = pass.group(shader(device, ShaderId::Surface, features));
      group.state_enable(state);
      group.bind_uniform("view_block", data.view_block);
      data.blocks.bind(group);
      render_scene::bind_textures(group, scene_, surface, textures);
      if (is_receiver) {
        group.bind_texture("depth_texture", depth_camera_->texture, data.nearest);
        group.constant_ref("clip_from_world", &data.depth_clip_from_world);
        group.constant_ref("depth_tolerance", &data.depth_tolerance);
      }
      return group;
    };
    if (data.display.is_xray || render_scene::lets_light_through(scene, mesh)) {
      BlendedObject &blended = data.blended.emplace_back(BlendedObject{index, blended_group_count, 1});
      // The backs of a convex object are behind its fronts. Points and lines have no sides.
      const bool has_two_groups = is_double_sided && !is_wireframe && mesh.topology == scene::Topology::Triangles;
      if (has_two_groups) {
        make_group(*data.blended_surfaces, fixed | State::CullFront).call(batch, index);
        blended.group_count++;
      }
      make_group(*data.blended_surfaces, fixed | (has_two_groups ? State::CullBack : side)).call(batch, index);
      blended_group_count += blended.group_count;
      continue;
    }
    const State state = fixed | side;
    draw::ShadingGroup *&group = groups[{features, state, textures}];
    if (!group) {
      group = &make_group(*data.surfaces, state);
    }
    group->call(batch, index);
  }
}

void Engine::order_blended(Data &data, const draw::View &view) const
{
  std::vector<scene::Bounds> boxes;
  for (const BlendedObject &blended : data.blended) {
    boxes.push_back(scene_.object(blended.object).bounds);
  }
  std::vector<std::uint32_t> order;
  for (const std::uint32_t place : render_scene::back_to_front(boxes, render_scene::eye_of(view))) {
    const BlendedObject &blended = data.blended[place];
    for (std::uint32_t i = 0; i < blended.group_count; i++) {
      order.push_back(blended.first_group + i);
    }
  }
  data.blended_surfaces->set_order(std::move(order));
}

}  // namespace gnomon::unlit
