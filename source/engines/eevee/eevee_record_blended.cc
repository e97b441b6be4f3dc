// SPDX-License-Identifier: MIT
// Records the pass that blends objects over what is behind them, and orders it.
#include "eevee_engine.hh"
#include "eevee_engine_data.hh"

#include "render_blend_order.hh"

#include <algorithm>
#include <utility>

namespace gnomon::eevee {

void Engine::record_blended(Data &data, draw::ObjectIndex object, const ObjectKind &kind)
{
  using gpu::State;
  StorageList &stl = data.stl;
  const scene::Mesh &mesh = scene_.scene().meshes()[scene_.object(object).mesh];
  const render_scene::MaterialClass material_class = render_scene::material_class(scene_.scene(), mesh);
  const render_scene::TextureSet textures = render_scene::textures_of(scene_.scene(), mesh, material_class);
  const State winding = stl.is_mirrored[object] ? State::FrontClockwise : State::None;
  const bool is_transmissive = scene_.scene().material_of(mesh).has_transmission();
  BlendedObject &blended = stl.blended.emplace_back(BlendedObject{object, stl.blended_group_count, 0, is_transmissive});
  const auto add_side = [&](State culled) {
    draw::ShadingGroup &group = data.psl->blend_pass.group(*kind.blend_shader);
    group.state_enable(culled | winding | render_scene::topology_state(mesh.topology));
    bind_lit(group, data);
    render_scene::bind_textures(group, scene_, material_class, textures);
    group.call(kind.batch, object);
    blended.group_count++;
    stl.blended_group_count++;
  };
  // The backs of a convex object are behind its fronts. Points and lines have no sides.
  if (scene_.scene().material_of(mesh).is_double_sided && mesh.topology == scene::Topology::Triangles) {
    add_side(State::CullFront);
  }
  add_side(State::CullBack);
}

void Engine::order_blended(Data &data, const draw::View &view)
{
  StorageList &stl = data.stl;
  if (stl.blended.empty()) {
    return;
  }
  data.visible.update(view, scene_.objects());
  BlendOrderKey key{.eye_ws = render_scene::eye_of(view),
                    .objects = scene_.objects().revision(),
                    .recording = stl.pass_recordings,
                    .visible = {},
                    .transmissive = {}};
  std::vector<std::uint32_t> hidden;
  for (std::uint32_t i = 0; i < stl.blended.size(); i++) {
    const bool is_visible = data.visible.contains(stl.blended[i].object);
    (is_visible ? key.visible : hidden).push_back(i);
  }
  for (const TransmissiveObject &transmissive : stl.transmissive) {
    if (!transmissive.is_blended && data.visible.contains(transmissive.object)) {
      key.transmissive.push_back(transmissive.object);
    }
  }
  if (stl.blend_ordered == key) {
    return;
  }
  std::vector<scene::Bounds> boxes;
  boxes.reserve(key.visible.size() + key.transmissive.size());
  for (const std::uint32_t i : key.visible) {
    boxes.push_back(scene_.object(stl.blended[i].object).bounds);
  }
  for (const draw::ObjectIndex object : key.transmissive) {
    boxes.push_back(scene_.object(object).bounds);
  }
  stl.groups_behind.clear();
  stl.groups_in_front.clear();
  const auto add_groups = [](std::vector<std::uint32_t> &groups, const BlendedObject &blended) {
    for (std::uint32_t group = 0; group < blended.group_count; group++) {
      groups.push_back(blended.first_group + group);
    }
  };
  bool is_behind = data.is_transmission_seen;
  for (const std::uint32_t place : render_scene::back_to_front(boxes, key.eye_ws)) {
    if (place >= key.visible.size()) {
      is_behind = false;
      continue;
    }
    const BlendedObject &blended = stl.blended[key.visible[place]];
    is_behind = is_behind && !blended.is_transmissive;
    add_groups(is_behind ? stl.groups_behind : stl.groups_in_front, blended);
  }
  for (const std::uint32_t i : hidden) {
    add_groups(stl.groups_in_front, stl.blended[i]);
  }
  data.psl->blend_pass.set_order(stl.groups_in_front);
  stl.blend_ordered = std::move(key);
}

}  // namespace gnomon::eevee
