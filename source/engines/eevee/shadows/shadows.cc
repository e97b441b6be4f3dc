// SPDX-License-Identifier: MIT
#include "shadows.hh"

#include "shadow_octahedral.hh"
#include "shadow_view_volume.hh"

#include <algorithm>
#include <limits>
#include <utility>

namespace gnomon::eevee {

static LayerPass best_layer_pass(LayerPass asked, const gpu::Limits &limits)
{
  if (asked == LayerPass::Layered && !limits.has_vertex_layer) {
    throw gpu::Error("the layered shadow pass needs GL_ARB_shader_viewport_layer_array, which this device lacks");
  }
  if (asked != LayerPass::Best) {
    return asked;
  }
  return limits.has_vertex_layer ? LayerPass::Layered : LayerPass::Geometry;
}

/** The octahedral store checks the settings of exponential maps. \throws gpu::Error */
static void check(const ShadowSettings &settings)
{
  const auto check_range = [](const char *setting, auto value, auto low, auto high) {
    // false for NaN too.
    if (!(value >= low && value <= high)) {
      throw gpu::Error("shadow settings: {} {} is not in [{}, {}]", setting, value, low, high);
    }
  };
  constexpr int most = std::numeric_limits<int>::max();
  check_range("cube_size_px", settings.cube_size_px, 1, most);
  check_range("map_size_px", settings.map_size_px, 1, most);
  check_range("cascades.count", settings.cascades.count, 0, cascade_count_max);
  check_range("cascades.lambda", settings.cascades.lambda, 0.0F, 1.0F);
  const int width = settings.pcf.width;
  if (width == 0) {
    check_range("pcf.taps", settings.pcf.taps, 1, 64);
  }
  if (width != 0 && width != 1 && width != 3 && width != 5) {
    throw gpu::Error("shadow settings: pcf.width {} is not 0, 1, 3 or 5", width);
  }
}

void Shadows::sync(const gpu::Limits &device_limits, std::span<const ShadowLamp> lamps, const scene::Bounds &bounds_ws,
                   shared::LightBlock &light_block, const ShadowSettings &settings)
{
  check(settings);
  const LayerPass layer_pass = best_layer_pass(settings.layer_pass, device_limits);
  ShadowPlan plan = plan_shadows(lamps, settings, device_limits, plan_);
  std::vector<EsmLamp> esm_lamps;
  for (const ShadowPlace &place : plan.places) {
    if (place.given.array == ShadowArrayId::DistanceCube) {
      esm_lamps.push_back(esm_lamp(lamps[place.lamp], place, bounds_ws, settings));
    }
  }
  limits_ = plan.limits;
  const std::vector<std::string> octahedral_limits = OctahedralStore::limits_of(device_limits, esm_lamps);
  limits_.insert(limits_.end(), octahedral_limits.begin(), octahedral_limits.end());

  // Nothing throws from here on, so that a sync that fails leaves the shadows as they were.
  layer_pass_ = layer_pass;
  plan_ = std::move(plan);
  esm_lamps_ = std::move(esm_lamps);
  casters_.begin();
  seen_clip_from_world_.reset();
  recorded_counters_ = {};
  std::vector<ShadowSlot> before = std::exchange(slots_, {});
  if (settings.caster_faces != settings_.caster_faces) {
    before.clear();
  }
  settings_ = settings;
  for (const ShadowPlace &place : plan_.places) {
    ShadowSlot &slot = slots_.emplace_back();
    slot.lamp = lamps[place.lamp];
    slot.place = place;
    take_over(slot, before);
    shared::LightData &light = light_block.lights[slot.lamp.light];
    light.shadow_kind = place.technique->light_shadow_kind();
    light.shadow_index = place.entry;
  }
}

/** Take the layers that \a slot's lamp had in \a before, if their texels still are what they should be. */
void Shadows::take_over(ShadowSlot &slot, std::vector<ShadowSlot> &before) const
{
  const auto found =
      std::ranges::find_if(before, [&](const ShadowSlot &candidate) { return candidate.lamp.key == slot.lamp.key; });
  if (found == before.end()) {
    return;
  }
  ShadowSlot &old = *found;
  const ShadowTechnique &technique = *slot.place.technique;
  const ShadowRequest &given = slot.place.given;
  if (old.place.technique != &technique || old.place.given.size_px != given.size_px ||
      old.place.given.layer_count_max != given.layer_count_max ||
      technique.texel_key(old.lamp) != technique.texel_key(slot.lamp)) {
    return;
  }
  if (given.array == ShadowArrayId::Maps) {
    slot.place.first_layer = old.place.first_layer;
  }
  else if (old.place.first_layer != slot.place.first_layer) {
    return;
  }
  slot.near = old.near;
  slot.views = std::move(old.views);
  slot.fits = std::move(old.fits);
  slot.drawn = old.drawn;
  slot.up_to_date = old.up_to_date;
  slot.drawn_now = old.drawn_now;
}

void Shadows::resize(gpu::Device &device, ShadowArrayId id, int layers)
{
  int size_px = 0;
  bool has_content = false;
  for (const ShadowSlot &slot : slots_) {
    if (slot.place.given.array == id) {
      size_px = std::max(size_px, slot.place.given.size_px);
      // The cube is a scratch: no lamp needs its texels after its layer was filtered.
      has_content = has_content || (slot.drawn != 0 && id != ShadowArrayId::DistanceCube);
    }
  }
  LayerArray &array = arrays_[std::size_t(id)];
  array.resize(device, size_px, layers, has_content);
  bindings_[std::size_t(id)] =
      array.texture() ? draw::TextureBinding{array.texture().id(), sampler_.id()} : draw::TextureBinding{};
}

void Shadows::allocate(gpu::Device &device, ShaderCache &shaders)
{
  const bool has_depths = cube_count() + map_count() > 0;
  if (!has_depths) {
    shadow_block_buffer_ = {};
  }
  else if (!shadow_block_buffer_) {
    sampler_ = device.create_sampler({.name = "shadow_sampler"});
    shadow_block_buffer_ =
        device.create_buffer({"shadow_block", gpu::BufferKind::Uniform, sizeof(shared::ShadowBlock)});
    is_block_dirty_ = true;
  }
  resize(device, ShadowArrayId::Cubes, plan_.runs[std::size_t(ShadowArrayId::Cubes)].end());
  resize(device, ShadowArrayId::DistanceCube, lamp_count(ShadowArrayId::DistanceCube) > 0 ? 6 : 0);
  if (map_count() == 0) {
    resize(device, ShadowArrayId::Maps, 0);
  }
  octahedral_.sync(device, shaders, esm_lamps_);
  for (ShadowSlot &slot : slots_) {
    if (slot.place.given.array == ShadowArrayId::DistanceCube &&
        octahedral_.must_record(std::size_t(slot.place.entry))) {
      slot.invalidate(~0U);
    }
  }
  place_render_blocks(device);
}

void Shadows::place_render_blocks(gpu::Device &device)
{
  const std::uint32_t alignment = device.limits().uniform_offset_alignment;
  const auto stride = std::uint32_t((sizeof(shared::ShadowRenderBlock) + alignment - 1) / alignment * alignment);
  std::uint32_t size = 0;
  for (ShadowSlot &slot : slots_) {
    slot.render_offset_bytes = size;
    size += stride;
  }
  if (size == 0) {
    render_buffer_ = {};
  }
  else if (!render_buffer_ || render_buffer_.size_bytes() != size) {
    // A buffer of many blocks may be larger than one block may be, so it is a storage buffer.
    render_buffer_ = device.create_buffer({"shadow_render_block", gpu::BufferKind::Storage, size});
  }
}

void Shadows::finish()
{
  casters_.finish();
  std::vector<glm::vec3> positions_ws;
  for (ShadowSlot &slot : slots_) {
    update_for_casters(slot, casters_);
    write_block(slot);
    positions_ws.push_back(slot.lamp.position_ws());
  }
  casters_.distances().keep_only(positions_ws, casters_.list());
}

void Shadows::write_block(const ShadowSlot &slot)
{
  slot.place.technique->write_block(slot, shadow_block_);
  is_block_dirty_ = true;
}

/** Give each map its layers. Layers keep their places, except those of a sun that needs more where there is no gap. */
void Shadows::place_maps()
{
  LayerRuns &runs = plan_.runs[std::size_t(ShadowArrayId::Maps)];
  const auto place_all = [&](auto &&is_placed) {
    for (ShadowSlot &slot : slots_) {
      if (slot.place.given.array == ShadowArrayId::Maps && is_placed(slot)) {
        const int first_layer = runs.place(slot.lamp.key, int(slot.views.size()));
        if (first_layer != slot.place.first_layer) {
          slot.place.first_layer = first_layer;
          slot.invalidate(~0U);
        }
      }
    }
  };
  const auto grows = [&](const ShadowSlot &slot) { return int(slot.views.size()) > runs.count_of(slot.lamp.key); };
  // Layers that are not needed any more first, for those that grow.
  place_all([&](const ShadowSlot &slot) { return !grows(slot); });
  place_all(grows);
  if (runs.end() > plan_.map_layers_max) {
    // The gaps do not fit into the limits.
    runs.clear();
    place_all([](const ShadowSlot & /*slot*/) { return true; });
  }
}

void Shadows::fit_views(gpu::Device &device, const ShadowView &view)
{
  int layers_max = 0;
  for (ShadowSlot &slot : slots_) {
    slot.place.technique->fit_views(slot, view, casters_, settings_);
    layers_max += slot.place.given.array == ShadowArrayId::Maps ? slot.place.given.layer_count_max : 0;
  }
  if (layers_max == 0) {
    return;
  }
  place_maps();
  // Layers that a wider view of the same lamps needed stay for the next such view.
  const int layers_now = array(ShadowArrayId::Maps).layer_count();
  resize(device, ShadowArrayId::Maps,
         std::max(plan_.runs[std::size_t(ShadowArrayId::Maps)].end(), std::min(layers_now, layers_max)));
  for (const ShadowSlot &slot : slots_) {
    if (slot.place.given.array == ShadowArrayId::Maps) {
      write_block(slot);
    }
  }
}

void Shadows::discard_recorded()
{
  recorded_counters_ = {};
  for (ShadowSlot &slot : slots_) {
    if ((slot.recorded_drawn | slot.recorded_up_to_date) != 0) {
      slot.recorded_drawn = slot.recorded_up_to_date = 0;
      write_block(slot);
    }
  }
}

void Shadows::update(gpu::Device &device, const draw::View &view, float pixel_size, const draw::Pass &pass,
                     gpu::CommandList &list, const std::function<std::vector<float>()> &read_depths)
{
  discard_recorded();
  if (seen_clip_from_world_ != view.clip_from_world()) {
    visible_ = visible_range(view, visible_corners(view, casters_.bounds_ws()));
    const bool has_sun =
        std::ranges::any_of(slots_, [](const ShadowSlot &slot) { return slot.lamp.kind == scene::LampKind::Sun; });
    if (has_sun && settings_.cascades.is_fitted_to_depth && read_depths) {
      narrow_to_depths(view, read_depths(), visible_);
    }
    fit_views(device, {view, visible_, pixel_size});
    seen_clip_from_world_ = view.clip_from_world();
  }
  // Array by array: the lamps of the distance cube take turns with it.
  for (std::size_t id = 0; id < shadow_array_count; id++) {
    for (ShadowSlot &slot : slots_) {
      if (std::size_t(slot.place.given.array) != id) {
        continue;
      }
      const ShadowTechnique &technique = *slot.place.technique;
      const LayerMask missing = technique.layers_needed(slot, visible_) & slot.all_layers() & ~slot.up_to_date;
      if (missing != 0) {
        technique.record(slot, missing,
                         {device, pass, list, casters_, arrays_[id], octahedral_, render_buffer_, render_block_,
                          layer_pass_, recorded_counters_});
        write_block(slot);
      }
    }
  }
  if (is_block_dirty_ && shadow_block_buffer_) {
    device.update(shadow_block_buffer_, shadow_block_);
    is_block_dirty_ = false;
  }
}

void Shadows::submitted()
{
  for (ShadowSlot &slot : slots_) {
    slot.drawn |= slot.recorded_drawn;
    slot.drawn_now |= slot.recorded_drawn;
    slot.up_to_date |= slot.recorded_up_to_date;
    slot.recorded_drawn = slot.recorded_up_to_date = 0;
  }
  const ShadowCounters recorded = std::exchange(recorded_counters_, {});
  counters_.lamps_updated += recorded.lamps_updated;
  counters_.faces_drawn += recorded.faces_drawn;
  counters_.faces_skipped += recorded.faces_skipped;
  counters_.caster_draws += recorded.caster_draws;
}

void Shadows::begin_picture()
{
  for (ShadowSlot &slot : slots_) {
    slot.drawn_now = 0;
  }
}

void Shadows::invalidate()
{
  for (ShadowSlot &slot : slots_) {
    slot.invalidate(~0U);
  }
}

Feature Shadows::features() const
{
  Feature features = Feature::None;
  for (const ShadowSlot &slot : slots_) {
    features = features | slot.place.technique->features(slot.place.kind);
  }
  return features;
}

void Shadows::bind(draw::ShadingGroup &group) const
{
  if (cube_count() + map_count() > 0) {
    group.bind_uniform("shadow_block", shadow_block_buffer_);
    group.bind_texture_ref("shadow_cubes", &bindings_[std::size_t(ShadowArrayId::Cubes)]);
    group.bind_texture_ref("shadow_maps", &bindings_[std::size_t(ShadowArrayId::Maps)]);
  }
  if (lamp_count(ShadowArrayId::DistanceCube) > 0) {
    octahedral_.bind(group);
  }
}

std::size_t Shadows::lamp_count(ShadowArrayId id) const
{
  return std::size_t(
      std::ranges::count_if(slots_, [id](const ShadowSlot &slot) { return slot.place.given.array == id; }));
}

const ShadowSlot *Shadows::slot_of(const shared::LightData &light) const
{
  const auto found = std::ranges::find_if(slots_, [&](const ShadowSlot &slot) {
    return slot.place.technique->light_shadow_kind() == light.shadow_kind && slot.place.entry == light.shadow_index;
  });
  return found == slots_.end() ? nullptr : &*found;
}

ShadowInspection Shadows::inspection(const ShadowSlot &slot) const
{
  return {shadow_block_, octahedral_, array(slot.place.given.array), casters_.bounds_ws()};
}

double Shadows::texel_size(const shared::LightData &light, const glm::dvec3 &position_ws) const
{
  const ShadowSlot *slot = slot_of(light);
  return slot ? slot->place.technique->texel_size(*slot, inspection(*slot), position_ws) : 0.0;
}

std::optional<ShadowLayers> Shadows::layers(const shared::LightData &light) const
{
  const ShadowSlot *slot = slot_of(light);
  return slot ? std::optional(slot->place.technique->layers(*slot, inspection(*slot))) : std::nullopt;
}

std::vector<ShadowState> Shadows::states() const
{
  std::vector<ShadowState> states;
  for (const ShadowSlot &slot : slots_) {
    states.push_back({.light = slot.lamp.light,
                      .array = array(slot.place.given.array).name(),
                      .size_px = slot.place.given.size_px,
                      .layer_count = int(slot.views.size()),
                      .drawn = slot.drawn,
                      .up_to_date = slot.up_to_date,
                      .drawn_now = slot.drawn_now});
  }
  return states;
}

}  // namespace gnomon::eevee
