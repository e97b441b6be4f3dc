// SPDX-License-Identifier: MIT
#include "shadow_technique.hh"

#include "shadow_cube.hh"
#include "shadow_octahedral.hh"
#include "shadow_spot.hh"
#include "shadow_sun.hh"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>

namespace gnomon::eevee {

std::span<const ShadowTechnique *const> shadow_techniques()
{
  static const std::array<const ShadowTechnique *, 4> techniques = {
      &shadow_cube_technique(), &shadow_spot_technique(), &shadow_sun_technique(), &shadow_octahedral_technique()};
  return techniques;
}

const ShadowTechnique &technique_of(const ShadowLamp &lamp, scene::ShadowKind kind)
{
  const auto found = std::ranges::find_if(
      shadow_techniques(), [&](const ShadowTechnique *technique) { return technique->serves(lamp, kind); });
  GNOMON_ASSERT(found != shadow_techniques().end(), "lamp '{}': no technique for its shadow", lamp.name);
  return **found;
}

/** Whether the layers are the faces of a whole cube, which need no frustums. */
static bool is_whole_cube(const ShadowSlot &slot)
{
  return slot.views.size() == 6 && slot.crop == whole_map;
}

/**
 * The planes outside of which no caster darkens a texel of \a view. Those between a sun and its near plane are clamped
 * to that plane.
 */
static draw::CullingPlanes caster_planes(const ShadowSlot &slot, const draw::View &view)
{
  draw::CullingPlanes planes = view.culling_planes();
  if (slot.lamp.kind == scene::LampKind::Sun) {
    planes[draw::View::near_plane] = {0.0F, 0.0F, 0.0F, 1.0F};
  }
  return planes;
}

LayerMask touched_layers(const ShadowSlot &slot, const scene::Bounds &bounds_ws, const draw::CullingVolume &volume)
{
  const glm::vec3 position_ws = slot.lamp.position_ws();
  const float range = slot.lamp.shadow_range();
  if (!std::isinf(range) && distance_to(bounds_ws, position_ws) > range) {
    return 0;
  }
  if (is_whole_cube(slot)) {
    const float half_size = 1.0F / shared::cube_uv_scale(float(slot.place.given.size_px));
    return cube_face_mask({bounds_ws.min - position_ws, bounds_ws.max - position_ws}, half_size);
  }
  LayerMask layers = 0;
  for (std::size_t i = 0; i < slot.views.size(); i++) {
    layers |= draw::touches(caster_planes(slot, slot.views[i]), volume) ? 1U << i : 0U;
  }
  return layers;
}

/** Update the near plane for \a casters. \return whether it changed, or no layer is up to date. */
static bool update_near(ShadowSlot &slot, ShadowCasters &casters)
{
  const glm::vec3 &position_ws = slot.center_ws;
  const float range = slot.lamp.shadow_range();
  const auto is_in_range = [&](const scene::Bounds &box) { return distance_to(box, position_ws) <= range; };
  if (slot.up_to_date != 0 && std::ranges::none_of(casters.changed(), is_in_range)) {
    return false;
  }
  const std::optional<float> clip_start = slot.lamp.shadow.clip_start;
  const float near = clip_start ? *clip_start : lamp_near(position_ws, range, casters.list(), &casters.distances());
  if (slot.up_to_date != 0 && slot.center_near == near) {
    return false;
  }
  slot.near = slot.center_near = near;
  return true;
}

void update_for_casters(ShadowSlot &slot, ShadowCasters &casters)
{
  LayerMask touched = 0;
  for (const scene::Bounds &box : casters.changed()) {
    touched |= touched_layers(slot, box, {box.center(), box.radius()});
  }
  slot.invalidate(slot.place.technique->changed_layers(touched));
  if (slot.lamp.kind != scene::LampKind::Sun && update_near(slot, casters)) {
    slot.place.technique->set_lamp_views(slot);
  }
}

void ShadowTechnique::set_lamp_views(ShadowSlot &slot) const
{
  set_whole_views(slot);
  slot.views = slot.whole_views;
  slot.crop = whole_map;
  slot.crop_revision = 0;
  slot.looked_up = ~0U;
  slot.invalidate(~0U);
}

void crop_views(ShadowSlot &slot, const VisibleRange &visible)
{
  const double inner = slot.place.technique->inner_share(slot);
  if (slot.crop_revision == visible.revision || inner == 0.0) {
    return;
  }
  slot.crop_revision = visible.revision;
  slot.looked_up = visible.boxes.empty() ? ~0U : 0U;
  const std::vector<draw::View> &whole = slot.whole_views;
  std::optional<MapCrop> needed;
  for (std::size_t i = 0; i < whole.size() && !visible.boxes.empty(); i++) {
    if (const std::optional<MapCrop> crop = map_crop(whole[i], inner, slot.size_px, visible.boxes)) {
      slot.looked_up |= 1U << i;
      needed = needed ? united(*needed, *crop) : *crop;
    }
  }
  if (const MapCrop crop = needed.value_or(whole_map); crop != slot.crop) {
    slot.crop = crop;
    std::ranges::transform(whole, slot.views.begin(), [&](const draw::View &view) { return cropped_view(view, crop); });
    slot.invalidate(~0U);
  }
}

LayerMask needed_layers(const ShadowSlot &slot, const VisibleRange &visible)
{
  return slot.place.technique->layers_needed(slot, visible) & slot.looked_up & slot.all_layers();
}

/** \a view restricted to \a rows of a layer with an edge of \a size_px texels, and a texel on each side. */
static draw::View view_of_rows(const draw::View &view, const LayerRows &rows, int size_px)
{
  const float center = 2.0F * (float(rows.first) + 0.5F * float(rows.count)) / float(size_px) - 1.0F;
  return cropped_view(view, {0.0F, center}, {1.0F, float(size_px) / float(rows.count + 2)});
}

/** Remove casters that touch no texel of \a rows from those of the recording, which are of the one \a layer. */
static void keep_casters_of_rows(const ShadowSlot &slot, int layer, const LayerRows &rows,
                                 const ShadowRecording &recording)
{
  const draw::View view = view_of_rows(slot.views[std::size_t(layer)], rows, slot.size_px);
  draw::test_volumes(caster_planes(slot, view), recording.casters.volumes(), recording.is_touching);
  for (std::size_t i = 0; i < recording.is_touching.size(); i++) {
    recording.caster_layers[i] = recording.is_touching[i] != 0 ? recording.caster_layers[i] : std::uint8_t(0);
  }
}

/** Write the layers of \a missing that each caster touches to the recording. \return those that one of them touches */
static LayerMask find_caster_layers(const ShadowSlot &slot, LayerMask missing, const ShadowRecording &recording)
{
  const std::vector<Caster> &list = recording.casters.list();
  std::vector<std::uint8_t> &touched = recording.caster_layers;
  std::vector<std::uint8_t> &is_touching = recording.is_touching;
  const glm::vec3 position_ws = slot.lamp.position_ws();
  const float range = slot.lamp.shadow_range();
  touched.assign(list.size(), 0);
  if (is_whole_cube(slot)) {
    for (std::size_t i = 0; i < list.size(); i++) {
      touched[i] = std::uint8_t(touched_layers(slot, list[i].bounds_ws, {}) & missing);
    }
  }
  else {
    for (LayerMask rest = missing; rest != 0; rest &= rest - 1) {
      const int layer = std::countr_zero(rest);
      draw::test_volumes(caster_planes(slot, slot.views[std::size_t(layer)]), recording.casters.volumes(), is_touching);
      for (std::size_t i = 0; i < list.size(); i++) {
        touched[i] = std::uint8_t(touched[i] | is_touching[i] << layer);
      }
    }
    for (std::size_t i = 0; i < list.size() && !std::isinf(range); i++) {
      const bool is_in_range = touched[i] != 0 && distance_to(list[i].bounds_ws, position_ws) <= range;
      touched[i] = is_in_range ? touched[i] : std::uint8_t(0);
    }
  }
  LayerMask all = 0;
  for (const std::uint8_t layers : touched) {
    all |= layers;
  }
  return all;
}

/** Update \a slot after the recording of \a part, and count the layers just recorded. \a drawn: those that it draws. */
static void note_recorded(ShadowSlot &slot, const LayerPart &part, LayerMask drawn, ShadowCounters &counters)
{
  const int next_row = part.rows ? part.rows->first + part.rows->count : slot.size_px;
  if (drawn != 0 && next_row < slot.size_px) {
    slot.recorded_partial = {std::countr_zero(part.layers), next_row};
    return;
  }
  if (part.rows) {
    slot.recorded_partial.reset();
  }
  slot.recorded_drawn |= drawn;
  slot.recorded_up_to_date |= part.layers;
  if (drawn != 0) {
    counters.lamps_updated++;
    counters.faces_drawn += std::uint64_t(std::popcount(drawn));
    counters.faces_skipped += std::uint64_t(std::popcount(slot.all_layers() & ~drawn));
  }
}

/** Write the matrices of the slot's views for the pass that draws casters. */
static void write_render_block(const ShadowSlot &slot, const ShadowRecording &recording)
{
  shared::ShadowRenderBlock block{};
  for (std::size_t i = 0; i < slot.views.size(); i++) {
    if ((slot.placed >> i & 1U) != 0) {
      block.clip_from_world[slot.index_of(int(i))] = slot.views[i].clip_from_world();
    }
  }
  block.size_px = float(slot.size_px);
  recording.list.update(recording.render_buffer, slot.render_offset_bytes, std::as_bytes(std::span(&block, 1)));
  recording.render_block = {recording.render_buffer.id(), slot.render_offset_bytes, sizeof(block)};
}

/** Record the casters that find_caster_layers found in \a layers. */
static void record_instances(const ShadowSlot &slot, LayerMask layers, const ShadowRecording &recording)
{
  const std::vector<Caster> &casters = recording.casters.list();
  std::ranges::for_each(recording.casters.calls(), &draw::InstanceCall::clear);
  for (std::size_t i = 0; i < casters.size(); i++) {
    for (LayerMask rest = recording.caster_layers[i] & layers; rest != 0; rest &= rest - 1) {
      casters[i].instances->add(casters[i].object, std::uint32_t(slot.index_of(std::countr_zero(rest))));
      recording.counters.caster_draws++;
    }
  }
  // Casters in front of the near plane are clamped to it, unless the lamp has a clip_start, which suns have not. The
  // pass state has depth clamping; the argument is the state to remove.
  const bool is_clipped = slot.lamp.shadow.clip_start && slot.lamp.kind != scene::LampKind::Sun;
  recording.pass.record(slot.views.front(), recording.list, is_clipped ? gpu::State::DepthClamp : gpu::State::None);
}

LayerMask record_depths(ShadowSlot &slot, const LayerPart &part, bool is_empty_drawn, const ShadowRecording &recording)
{
  const LayerMask missing = part.layers;
  gpu::CommandList &list = recording.list;
  const LayerMask with_casters = find_caster_layers(slot, missing, recording);
  const LayerMask drawn = is_empty_drawn ? missing : with_casters;
  if (part.rows) {
    keep_casters_of_rows(slot, std::countr_zero(missing), *part.rows, recording);
  }
  write_render_block(slot, recording);
  fmt::memory_buffer name;
  const auto name_of = [&](std::string_view what, std::optional<int> layer = {}) {
    name.clear();
    fmt::format_to(std::back_inserter(name), "shadow of {}, {}", slot.lamp.name, what);
    if (layer) {
      fmt::format_to(std::back_inserter(name), " {}", *layer);
    }
    return std::string_view(name.data(), name.size());
  };
  const ShadowRequest &given = slot.place.given;
  const std::string_view layer_name = given.array == ShadowArrayId::Maps ? "map" : "face";
  gpu::PassActions clear{.viewport = {.size_px = glm::ivec2(slot.size_px)}};
  if (part.rows) {
    clear.scissor = {{0, part.rows->first}, {slot.size_px, part.rows->count}};
  }
  else if (slot.size_px < recording.array.texture().desc().width) {
    // The rest of a layer is not looked up. To clear it would take longer than to draw a small shadow.
    clear.scissor = clear.viewport;
  }
  gpu::PassActions keep = clear;
  keep.depth_load = gpu::LoadAction::Load;
  const bool is_one_pass = recording.layer_pass != LayerPass::Single && with_casters != 0;
  // One clear of all layers is cheaper than one clear for each layer, but must not clear valid layers.
  const bool is_cleared_at_once = is_one_pass && drawn == (slot.placed & slot.all_layers());
  for (LayerMask rest = is_cleared_at_once ? 0 : drawn; rest != 0; rest &= rest - 1) {
    const int layer = std::countr_zero(rest);
    list.begin_pass(name_of(layer_name, layer), recording.array.framebuffer(recording.device, slot.array_layer(layer)),
                    clear);
    if (recording.layer_pass == LayerPass::Single) {
      record_instances(slot, 1U << layer, recording);
    }
    list.end_pass();
  }
  if (is_one_pass) {
    list.begin_pass(name_of("all layers"),
                    recording.array.framebuffer(recording.device, slot.place.first_layer, slot.placed_count()),
                    is_cleared_at_once ? clear : keep);
    record_instances(slot, missing, recording);
    list.end_pass();
  }
  note_recorded(slot, part, drawn, recording.counters);
  return drawn;
}

glm::vec3 reach_from(const glm::vec3 &position_ws, const scene::Bounds &bounds_ws)
{
  return glm::max(glm::abs(bounds_ws.min - position_ws), glm::abs(bounds_ws.max - position_ws));
}

ShadowLayers depth_layers(const ShadowSlot &slot, const ShadowInspection &inspection)
{
  ShadowLayers layers;
  layers.count = inspection.array.texture() ? int(slot.views.size()) : 0;
  layers.texture = layers.count > 0 ? &inspection.array.texture() : nullptr;
  layers.first_layer = slot.place.first_layer;
  layers.size_px = slot.size_px;
  layers.placed = slot.placed;
  layers.drawn = slot.drawn;
  if (slot.lamp.kind != scene::LampKind::Sun) {
    const glm::vec3 reach = reach_from(slot.lamp.position_ws(), inspection.caster_bounds_ws);
    layers.near_far = {{slot.near, std::numeric_limits<float>::max()}};
    layers.shown = {slot.near, std::min(std::max({reach.x, reach.y, reach.z}), slot.lamp.shadow_range())};
  }
  return layers;
}

}  // namespace gnomon::eevee
