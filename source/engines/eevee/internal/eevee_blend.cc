// SPDX-License-Identifier: MIT
#include "internal/eevee_blend.hh"

#include "internal/eevee_transmission.hh"
#include "render_blend_order.hh"
#include "render_surfaces.hh"

#include <utility>

namespace gnomon::eevee {

using gpu::State;

BlendPass::BlendPass(draw::ObjectBuffer &objects, const RenderBuffers &buffers)
    : buffers_(buffers), pass_("blend_pass", State::WriteColor | State::DepthNearerEqual | State::BlendOver, &objects)
{
}

void BlendPass::clear()
{
  pass_.clear();
  blended_.clear();
  group_count_ = 0;
  ordered_.reset();
}

void BlendPass::add(render_scene::RenderScene &scene, draw::ObjectIndex object, const gpu::BatchRange &batch,
                    const gpu::Shader &shader, const BindLit &bind)
{
  const scene::Mesh &mesh = scene.scene().meshes()[scene.object(object).mesh];
  const scene::Material &material = scene.scene().material_of(mesh);
  const render_scene::MaterialClass material_class = render_scene::material_class(scene.scene(), mesh);
  const render_scene::TextureSet textures = render_scene::textures_of(scene.scene(), mesh, material_class);
  const State winding = scene.objects().is_mirrored(object) ? State::FrontClockwise : State::None;
  Blended &blended = blended_.emplace_back(Blended{object, group_count_, 0, material.has_transmission()});
  const auto add_side = [&](State culled) {
    draw::ShadingGroup &group = pass_.group(shader);
    group.state_enable(culled | winding | render_scene::topology_state(mesh.topology));
    bind(group);
    render_scene::bind_textures(group, scene, material_class, textures);
    group.call(batch, object);
    blended.group_count++;
    group_count_++;
  };
  // The backs of a convex object are behind its fronts. Points and lines have no sides.
  if (material.is_double_sided && mesh.topology == scene::Topology::Triangles) {
    add_side(State::CullFront);
  }
  add_side(State::CullBack);
}

void BlendPass::order(const render_scene::RenderScene &scene, const draw::View &view, draw::VisibleObjects &visible,
                      std::span<const TransmissiveObject> transmissive, bool is_transmission_seen)
{
  if (blended_.empty()) {
    return;
  }
  visible.update(view, scene.objects());
  OrderKey key{.eye_ws = render_scene::eye_of(view), .objects = scene.objects().revision()};
  std::vector<std::uint32_t> hidden;
  for (std::uint32_t i = 0; i < blended_.size(); i++) {
    (visible.contains(blended_[i].object) ? key.visible : hidden).push_back(i);
  }
  for (const TransmissiveObject &one : transmissive) {
    if (!one.is_blended && visible.contains(one.object)) {
      key.transmissive.push_back(one.object);
    }
  }
  if (ordered_ == key) {
    return;
  }
  std::vector<scene::Bounds> boxes;
  boxes.reserve(key.visible.size() + key.transmissive.size());
  for (const std::uint32_t i : key.visible) {
    boxes.push_back(scene.object(blended_[i].object).bounds);
  }
  for (const draw::ObjectIndex object : key.transmissive) {
    boxes.push_back(scene.object(object).bounds);
  }
  groups_behind_.clear();
  groups_in_front_.clear();
  const auto add_groups = [](std::vector<std::uint32_t> &groups, const Blended &blended) {
    for (std::uint32_t group = 0; group < blended.group_count; group++) {
      groups.push_back(blended.first_group + group);
    }
  };
  bool is_behind = is_transmission_seen;
  for (const std::uint32_t place : render_scene::back_to_front(boxes, key.eye_ws)) {
    if (place >= key.visible.size()) {
      is_behind = false;
      continue;
    }
    const Blended &blended = blended_[key.visible[place]];
    is_behind = is_behind && !blended.is_transmissive;
    add_groups(is_behind ? groups_behind_ : groups_in_front_, blended);
  }
  for (const std::uint32_t i : hidden) {
    add_groups(groups_in_front_, blended_[i]);
  }
  pass_.set_order(groups_in_front_);
  ordered_ = std::move(key);
}

FrameStep BlendPass::behind_step()
{
  return {.name = "blend_behind",
          .summary = "Blended surfaces behind a surface that transmits light.",
          .part = FrameStep::Part::Rows,
          .need =
              [this](const FrameState &state) {
                return need_of_transmission(state, !pass_.is_empty() && !groups_behind_.empty(),
                                            "blended objects that are seen through others",
                                            "no blended object is behind all that transmits light");
              },
          .reads = forward_reads(),
          .writes = {"radiance"},
          .passes = {{&pass_, "blended objects that are seen through others"}},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                pass_.set_order(groups_behind_);
                record_pass(sample, list, buffers_.main_fb, drawn_over());
                pass_.set_order(groups_in_front_);
              }};
}

FrameStep BlendPass::step()
{
  return {.name = "blend",
          .summary = "Blended surfaces over what is behind them, from back to front.",
          .part = FrameStep::Part::Rows,
          .need =
              [this](const FrameState &state) {
                return !state.is_seen     ? Need{false, nothing_seen}
                       : pass_.is_empty() ? Need{false, "no material that is drawn is blended"}
                                          : Need{true, "blended objects, from back to front"};
              },
          .reads = forward_reads(),
          .writes = {"radiance"},
          .passes = {{&pass_, "blended objects, from back to front"}},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                record_pass(sample, list, buffers_.main_fb, drawn_over(sample.viewport.part_region()));
              }};
}

}  // namespace gnomon::eevee
