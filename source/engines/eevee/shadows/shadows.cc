// SPDX-License-Identifier: MIT
#include "shadows.hh"

#include "scene_shadows_state.hh"
#include "shadow_view_volume.hh"

#include <algorithm>
#include <bit>
#include <cstring>
#include <utility>

namespace gnomon::eevee {

Shadows::Shadows(SceneShadows &scene)
    : scene_(scene), id_(++scene.last_viewport_), visible_(std::make_unique<VisibleRange>())
{
  scene.viewports_.push_back(this);
  scene.viewports_revision_++;
}

Shadows::~Shadows()
{
  std::erase(scene_.viewports_, this);
  scene_.viewports_revision_++;
}

template <typename Action>
void Shadows::for_each_slot(Action &&action)
{
  std::ranges::for_each(scene_.state_->slots, action);
  std::ranges::for_each(slots_, action);
}

template <typename Action>
void Shadows::for_each_slot(Action &&action) const
{
  std::ranges::for_each(std::as_const(scene_.state_->slots), action);
  std::ranges::for_each(slots_, action);
}

void Shadows::allocate(gpu::Device &device)
{
  const bool has_depths = scene_.cube_count() + scene_.map_count() > 0;
  if (!has_depths) {
    block_buffer_ = {};
  }
  else if (!block_buffer_) {
    block_buffer_ = device.create_buffer({"shadow_block", gpu::BufferKind::Uniform, sizeof(shared::ShadowBlock)});
    is_block_written_ = false;
  }
}

/** \a view with one more pixel on each side: samples lie beside the centres of pixels. \a pixel_size: \see fit_sun */
static draw::View widened(const draw::View &view, float pixel_size)
{
  glm::mat4 clip_from_view = view.clip_from_view();
  for (int axis = 0; axis < 2; axis++) {
    const float factor = 1.0F / (1.0F + pixel_size * std::abs(clip_from_view[axis][axis]));
    for (int column = 0; column < 4; column++) {
      clip_from_view[column][axis] *= factor;
    }
  }
  return {view.view_from_world(), clip_from_view};
}

void Shadows::fit(gpu::Device &device, const draw::View &view, float pixel_size, const PictureDepths &depths)
{
  const Seen seen{view.clip_from_world(), view.hidden(), view.clip_planes(), pixel_size,
                  reads_depths() && !depths.depths.empty()};
  if (seen_ == seen) {
    return;
  }
  // A visible surface is inside of these bounds, whether it casts a shadow or not.
  scene::Bounds surfaces_ws = scene_.bounds_ws_;
  surfaces_ws.extend(scene_.state_->casters.bounds_ws());
  VisibleRange before = std::move(*visible_);
  *visible_ = visible_range(
      view, visible_corners(reads_depths() ? widened(view, pixel_size) : view, surfaces_ws, std::move(before.corners)));
  visible_->clusters = std::move(before.clusters);
  visible_->boxes = std::move(before.boxes);
  visible_->revision = before.revision;
  // The points of a sun change with each sample, and the depths do not.
  if (!has_clusters_ || depths.depths.empty() || !reads_depths()) {
    visible_->clusters = visible_clusters(reads_depths() ? depths : PictureDepths(), std::move(visible_->clusters));
    has_clusters_ = !depths.depths.empty();
    visible_->boxes.clear();
    visible_->revision = ++scene_.last_visible_revision_;
  }
  // Depths of an earlier view do not show all surfaces of this view.
  const bool has_boxes = !visible_->clusters.empty() && depths.view == view;
  if (has_boxes == visible_->boxes.empty()) {
    visible_->boxes = has_boxes ? visible_boxes(visible_->clusters) : std::vector<VisibleBox>();
    visible_->revision = ++scene_.last_visible_revision_;
  }
  for (ShadowSlot &slot : slots_) {
    slot.place.technique->fit_views(slot, {view, *visible_, pixel_size}, scene_.state_->casters, scene_.settings_);
  }
  scene_.place_maps(device);
  seen_ = seen;
}

/** Distance of the near plane from a point of a lamp that is \a offset away from its centre, metres. */
static float point_near(const ShadowSlot &slot, float offset)
{
  // The nearest caster is at least twice as far away as the near plane of the centre, \see lamp_near. Casters in front
  // of the near plane still cast shadows.
  return slot.lamp.shadow.clip_start
             ? slot.center_near
             : std::max(slot.center_near - 0.5F * offset, std::min(slot.center_near, 0.1F * offset));
}

/** Move the lamps to \a points. Layers of lamps that move become out of date. */
void Shadows::place_lamps(std::span<const LampPoint> points)
{
  if (points.empty()) {
    return;
  }
  for_each_slot([&](ShadowSlot &slot) {
    const auto point = std::ranges::find(points, slot.lamp.light, &LampPoint::light);
    if (point == points.end()) {
      return;
    }
    const float near = point_near(slot, point->offset);
    if (point->world_from_lamp == slot.lamp.world_from_lamp && near == slot.near) {
      return;
    }
    slot.lamp.world_from_lamp = point->world_from_lamp;
    slot.near = near;
    if (!slot.place.technique->follows_view()) {
      slot.place.technique->set_lamp_views(slot);
    }
    else {
      seen_.reset();
      slot.invalidate(~0U);
    }
  });
}

void Shadows::write_block(gpu::Device &device)
{
  if (!block_buffer_) {
    return;
  }
  const shared::ShadowBlock before = block_;
  for_each_slot([&](const ShadowSlot &slot) { slot.place.technique->write_block(slot, block_); });
  if (!is_block_written_ || std::memcmp(&before, &block_, sizeof(block_)) != 0) {
    device.update(block_buffer_, block_);
    is_block_written_ = true;
  }
}

/** The first \a count layers of \a layers. */
static LayerMask first_layers(LayerMask layers, int count)
{
  LayerMask rest = layers;
  for (int i = 0; i < count && rest != 0; i++) {
    rest &= rest - 1;
  }
  return layers & ~rest;
}

static int rows_of_part(int size_px)
{
  return std::clamp(layer_part_texels / size_px, 1, size_px);
}

/** The part of the layers \a missing that is recorded next: at most \a parts_max parts. */
static LayerPart next_part(const ShadowSlot &slot, LayerMask missing, int parts_max)
{
  if (parts_max == Shadows::no_parts_max || !slot.place.technique->has_divisible_layers()) {
    return {missing};
  }
  const int part_rows = rows_of_part(slot.size_px);
  const int layer_parts = (slot.size_px + part_rows - 1) / part_rows;
  const std::optional<PartialLayer> &partial = slot.recorded_partial;
  const bool has_begun = partial && (missing >> partial->layer & 1U) != 0;
  if (!has_begun && parts_max >= layer_parts) {
    return {first_layers(missing, parts_max / layer_parts)};
  }
  const int layer = has_begun ? partial->layer : std::countr_zero(missing);
  const int row = has_begun ? partial->next_row : 0;
  // No more than the rest, and without an overflow.
  const int rows = std::min(parts_max, layer_parts) * part_rows;
  return {1U << layer, LayerRows{row, std::min(rows, slot.size_px - row)}};
}

static int part_count(const ShadowSlot &slot, const LayerPart &part)
{
  const int part_rows = slot.place.technique->has_divisible_layers() ? rows_of_part(slot.size_px) : slot.size_px;
  const int rows = part.rows ? part.rows->count : slot.size_px;
  return std::popcount(part.layers) * ((rows + part_rows - 1) / part_rows);
}

UpdatedLayers Shadows::update(gpu::Device &device, const draw::View &view, float pixel_size, const draw::Pass &pass,
                              gpu::CommandList &list, std::span<const LampPoint> points, const PictureDepths &depths,
                              int parts_max)
{
  UpdatedLayers updated;
  // Discard the records of lists that were not submitted.
  recorded_counters_ = {};
  place_lamps(points);
  fit(device, view, pixel_size, depths);
  std::ranges::for_each(scene_.state_->slots, [&](ShadowSlot &slot) { crop_views(slot, *visible_); });
  scene_.place_cubes(device, *visible_);
  for_each_slot([](ShadowSlot &slot) { slot.discard_recorded(); });
  // Lamps are recorded array by array. The lamps of the distance cube use the same layers one after the other.
  for (std::size_t id = 0; id < shadow_array_count; id++) {
    for_each_slot([&](ShadowSlot &slot) {
      if (std::size_t(slot.place.given.array) != id) {
        return;
      }
      const ShadowTechnique &technique = *slot.place.technique;
      const LayerMask needed = needed_layers(slot, *visible_);
      const auto missing = [&] { return needed & ~slot.up_to_date & ~slot.recorded_up_to_date; };
      while (missing() != 0 && updated.part_count < parts_max) {
        const int left = parts_max == no_parts_max ? no_parts_max : parts_max - updated.part_count;
        const LayerPart part = next_part(slot, missing(), left);
        technique.record(slot, part,
                         {device, pass, list, scene_.state_->casters, scene_.state_->arrays[id],
                          scene_.state_->octahedral, scene_.render_buffer_, scene_.render_block_, scene_.layer_pass_,
                          recorded_counters_, caster_layers_, is_touching_});
        updated.part_count += part_count(slot, part);
      }
      updated.left_count += missing() != 0 ? part_count(slot, {missing()}) : 0;
    });
  }
  write_block(device);
  return updated;
}

void Shadows::invalidate_blended()
{
  const ShadowCasters &casters = scene_.state_->casters;
  for_each_slot([&](ShadowSlot &slot) {
    LayerMask touched = 0;
    for (const std::size_t i : casters.blended()) {
      touched |= touched_layers(slot, casters.list()[i].bounds_ws, casters.volumes()[i]);
    }
    slot.invalidate(slot.place.technique->changed_layers(touched));
  });
}

bool Shadows::reads_depths() const
{
  return scene_.settings_.is_fitted_to_depth &&
         (std::ranges::any_of(slots_, [](const ShadowSlot &slot) { return !slot.lamp.is_sampled; }) ||
          std::ranges::any_of(scene_.state_->slots,
                              [](const ShadowSlot &slot) { return slot.place.technique->inner_share(slot) > 0.0; }));
}

void Shadows::submitted()
{
  for_each_slot([&](ShadowSlot &slot) {
    if (slot.recorded_drawn != 0) {
      drawn_now_.push_back({slot.lamp.key, slot.recorded_drawn});
    }
    slot.drawn |= slot.recorded_drawn;
    slot.up_to_date |= slot.recorded_up_to_date;
    slot.partial = slot.recorded_partial;
    slot.discard_recorded();
  });
  const ShadowCounters recorded = std::exchange(recorded_counters_, {});
  counters_.lamps_updated += recorded.lamps_updated;
  counters_.faces_drawn += recorded.faces_drawn;
  counters_.faces_skipped += recorded.faces_skipped;
  counters_.caster_draws += recorded.caster_draws;
}

void Shadows::bind(draw::ShadingGroup &group) const
{
  if (scene_.cube_count() + scene_.map_count() > 0) {
    group.bind_uniform("shadow_block", block_buffer_);
    group.bind_texture_ref("shadow_cubes", &scene_.state_->bindings[std::size_t(ShadowArrayId::Cubes)]);
    group.bind_texture_ref("shadow_maps", &scene_.state_->bindings[std::size_t(ShadowArrayId::Maps)]);
  }
  if (scene_.lamp_count(ShadowArrayId::DistanceCube) > 0) {
    scene_.state_->octahedral.bind(group);
  }
}

const ShadowSlot *Shadows::slot_of(const shared::LightData &light) const
{
  const ShadowSlot *found = nullptr;
  for_each_slot([&](const ShadowSlot &slot) {
    if (slot.place.technique->light_shadow_kind() == light.shadow_kind && slot.place.entry == light.shadow_index) {
      found = &slot;
    }
  });
  return found;
}

ShadowInspection Shadows::inspection(const ShadowSlot &slot) const
{
  return {block_, scene_.state_->octahedral, scene_.array(slot.place.given.array), scene_.state_->casters.bounds_ws()};
}

std::optional<std::vector<double>> Shadows::texel_sizes(const shared::LightData &light,
                                                        std::span<const glm::dvec3> positions_ws) const
{
  const ShadowSlot *slot = slot_of(light);
  if (!slot) {
    return std::nullopt;
  }
  std::vector<double> sizes;
  sizes.reserve(positions_ws.size());
  for (const glm::dvec3 &position_ws : positions_ws) {
    sizes.push_back(slot->place.technique->texel_size(*slot, inspection(*slot), position_ws));
  }
  return sizes;
}

std::optional<ShadowLayers> Shadows::layers(const shared::LightData &light) const
{
  const ShadowSlot *slot = slot_of(light);
  return slot ? std::optional(slot->place.technique->layers(*slot, inspection(*slot))) : std::nullopt;
}

std::vector<ShadowState> Shadows::states() const
{
  std::vector<ShadowState> states;
  for_each_slot([&](const ShadowSlot &slot) {
    LayerMask drawn_now = 0;
    for (const auto &[lamp, layers] : drawn_now_) {
      drawn_now |= lamp == slot.lamp.key ? layers : 0;
    }
    states.push_back({.light = slot.lamp.light,
                      .array = scene_.array(slot.place.given.array).name(),
                      .size_px = slot.size_px,
                      .layer_count = int(slot.views.size()),
                      .drawn = slot.drawn,
                      .up_to_date = slot.up_to_date,
                      .drawn_now = drawn_now});
  });
  std::ranges::sort(states, {}, &ShadowState::light);
  return states;
}

}  // namespace gnomon::eevee
