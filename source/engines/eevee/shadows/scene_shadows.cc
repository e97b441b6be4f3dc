// SPDX-License-Identifier: MIT
#include "scene_shadows_state.hh"

#include "shadow_octahedral.hh"
#include "shadow_spot.hh"
#include "shadows.hh"

#include <algorithm>
#include <utility>

namespace gnomon::eevee {

static LayerPass best_layer_pass(LayerPass asked, const gpu::Limits &limits)
{
  if (asked == LayerPass::Layered && !limits.has_vertex_layer) {
    throw gpu::Error(
        "the layered shadow pass needs vertex shaders that write gl_Layer (GL_ARB_shader_viewport_layer_array), which "
        "this device lacks");
  }
  if (asked == LayerPass::Geometry && !limits.has_geometry_shader) {
    throw gpu::Error("the shadow pass with geometry shaders needs those, which this device lacks");
  }
  if (asked != LayerPass::Best) {
    return asked;
  }
  return limits.has_vertex_layer      ? LayerPass::Layered
         : limits.has_geometry_shader ? LayerPass::Geometry
                                      : LayerPass::Single;
}

/** \throws gpu::Error */
static void check(const ShadowSettings &settings)
{
  if (const std::string fault = scene::limit_fault(settings); !fault.empty()) {
    throw gpu::Error("shadow settings: {}", fault);
  }
  if (!pcf_kernel_of(text_of(settings.pcf))) {
    throw gpu::Error("shadow settings: pcf.width {} and pcf.taps {} are none of 1, 3x3, 5x5, and 0 with 1 to {}",
                     settings.pcf.width, settings.pcf.taps, PcfKernel::taps_max);
  }
}

/** Move the layers of the same lamp from \a before to \a slot if their texels are still valid. */
static void take_over(ShadowSlot &slot, std::vector<ShadowSlot> &before)
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
  else if (slot.placed == 0) {
    slot.place.first_layer = old.place.first_layer;
    slot.placed = old.placed;
  }
  else if (old.place.first_layer != slot.place.first_layer ||
           (~old.placed & ((1U << given.layer_count_max) - 1U)) != 0) {
    return;
  }
  slot.near = old.near;
  slot.center_near = old.center_near;
  slot.size_px = old.size_px;
  slot.views = std::move(old.views);
  slot.whole_views = std::move(old.whole_views);
  slot.crop = old.crop;
  slot.crop_revision = old.crop_revision;
  slot.looked_up = old.looked_up;
  slot.fits = std::move(old.fits);
  slot.drawn = old.drawn;
  slot.up_to_date = old.up_to_date;
  slot.partial = old.partial;
}

SceneShadows::SceneShadows() : state_(std::make_unique<State>()) {}

SceneShadows::~SceneShadows() = default;

template <typename Action>
void SceneShadows::for_each_slot(Action &&action)
{
  std::ranges::for_each(state_->slots, action);
  for (Shadows *viewport : viewports_) {
    std::ranges::for_each(viewport->slots_, action);
  }
}

void SceneShadows::sync(const gpu::Limits &device_limits, std::span<const ShadowLamp> lamps,
                        const scene::Bounds &bounds_ws, std::span<shared::LightData> lights,
                        const ShadowSettings &settings)
{
  check(settings);
  const LayerPass layer_pass = best_layer_pass(settings.layer_pass, device_limits);
  ShadowPlan plan = plan_shadows(lamps, settings, device_limits, state_->plan, std::max(int(viewports_.size()), 1));
  std::vector<EsmLamp> esm_lamps;
  for (const ShadowPlace &place : plan.places) {
    if (place.given.array == ShadowArrayId::DistanceCube) {
      esm_lamps.push_back(esm_lamp(lamps[place.lamp], place, bounds_ws, settings));
    }
  }
  limits_ = plan.limits;
  const std::vector<std::string> octahedral_limits = OctahedralStore::limits_of(device_limits, esm_lamps);
  limits_.insert(limits_.end(), octahedral_limits.begin(), octahedral_limits.end());

  // The code below does not throw, so that a failed sync leaves the shadows unchanged.
  layer_pass_ = layer_pass;
  state_->plan = std::move(plan);
  state_->esm_lamps = std::move(esm_lamps);
  bounds_ws_ = bounds_ws;
  state_->casters.begin();
  const bool is_kept = settings.caster_faces == settings_.caster_faces;
  settings_ = settings;
  // Other views move, and would need more layers again and again. The layers of their cubes are those of the plan.
  const bool is_placed_by_view = settings.is_fitted_to_depth;
  /** \a viewport: LayerOwner::viewport. */
  const auto replace = [&](std::vector<ShadowSlot> &slots, std::uint64_t viewport) {
    std::vector<ShadowSlot> before = std::exchange(slots, {});
    for (const ShadowPlace &place : state_->plan.places) {
      if (place.technique->follows_view() == (viewport != 0)) {
        const ShadowLamp &lamp = lamps[place.lamp];
        slots.push_back({.lamp = lamp,
                         .center_ws = lamp.position_ws(),
                         .place = place,
                         .size_px = place.given.size_px,
                         .viewport = viewport,
                         .placed = is_placed_by_view && place.given.array == ShadowArrayId::Cubes ? 0U : ~0U});
        if (is_kept) {
          take_over(slots.back(), before);
        }
      }
    }
  };
  replace(state_->slots, 0);
  for (Shadows *viewport : viewports_) {
    replace(viewport->slots_, viewport->id_);
    viewport->seen_.reset();
    viewport->recorded_counters_ = {};
  }
  std::vector<LayerOwner> owners;
  for_each_slot([&](const ShadowSlot &slot) { owners.push_back({slot.lamp.key, slot.viewport}); });
  state_->map_runs.keep_only(owners);
  for (const ShadowPlace &place : state_->plan.places) {
    shared::LightData &light = lights[std::size_t(lamps[place.lamp].light)];
    light.shadow_kind = place.technique->light_shadow_kind();
    light.shadow_index = place.entry;
  }
}

void SceneShadows::resize(gpu::Device &device, ShadowArrayId id, int layers)
{
  int size_px = 0;
  int planned_px = 0;
  int layers_max = 0;
  bool has_content = false;
  for_each_slot([&](const ShadowSlot &slot) {
    if (slot.place.given.array == id) {
      planned_px = std::max(planned_px, slot.place.given.size_px);
      layers_max += slot.place.given.layer_count_max;
      size_px = std::max(size_px, slot.size_px);
      // The distance cube is temporary: its texels are not needed after the octahedral layer was filtered.
      has_content = has_content || ((slot.drawn != 0 || slot.partial) && id != ShadowArrayId::DistanceCube);
    }
  });
  LayerArray &array = state_->arrays[std::size_t(id)];
  if (id == ShadowArrayId::Maps && array.texture()) {
    // Small changes of the needed size do not justify a new texture, and a view that needs more cascades than the last
    // view should seldom need one. Together, both may be more than what was planned.
    const int size_now = array.texture().desc().width;
    const bool is_near = size_now >= size_px && size_now <= size_px + size_px / 2;
    const int kept_px = settings_.cascades.can_resize && is_near ? size_now : size_px;
    const int kept_layers = std::max(layers, std::min(array.layer_count(), layers_max));
    const auto texels = [](int edge_px, int count) { return std::int64_t(edge_px) * edge_px * count; };
    if (texels(kept_px, kept_layers) <= texels(planned_px, layers_max)) {
      size_px = kept_px;
      layers = kept_layers;
    }
  }
  array.resize(device, size_px, layers, has_content);
  state_->bindings[std::size_t(id)] =
      array.texture() ? draw::TextureBinding{array.texture().id(), sampler_.id()} : draw::TextureBinding{};
}

void SceneShadows::allocate(gpu::Device &device, ShaderCache &shaders)
{
  if (cube_count() + map_count() > 0 && !sampler_) {
    sampler_ = device.create_sampler({.name = "shadow_sampler"});
  }
  if (!settings_.is_fitted_to_depth || cube_count() == 0) {
    resize(device, ShadowArrayId::Cubes, state_->plan.cubes.end());
  }
  resize(device, ShadowArrayId::DistanceCube, lamp_count(ShadowArrayId::DistanceCube) > 0 ? 6 : 0);
  if (map_count() == 0) {
    resize(device, ShadowArrayId::Maps, 0);
  }
  state_->octahedral.sync(device, shaders, state_->esm_lamps);
  for (ShadowSlot &slot : state_->slots) {
    if (slot.place.given.array == ShadowArrayId::DistanceCube &&
        state_->octahedral.must_record(std::size_t(slot.place.entry))) {
      slot.invalidate(~0U);
    }
  }
  place_render_blocks(device);
}

/** Assign one block to each lamp. Viewports share it, because each command list writes it before each use. */
void SceneShadows::place_render_blocks(gpu::Device &device)
{
  const std::uint32_t alignment = device.limits().uniform_offset_alignment;
  const auto stride = std::uint32_t((sizeof(shared::ShadowRenderBlock) + alignment - 1) / alignment * alignment);
  for_each_slot([&](ShadowSlot &slot) { slot.render_offset_bytes = stride * std::uint32_t(slot.place.index); });
  const std::size_t size = state_->plan.places.size() * stride;
  if (size == 0) {
    render_buffer_ = {};
  }
  else if (!render_buffer_ || render_buffer_.size_bytes() != size) {
    // The buffer is a storage buffer because the size of uniform buffers is limited to that of one block.
    render_buffer_ = device.create_buffer({"shadow_render_block", gpu::BufferKind::Storage, size});
  }
}

void SceneShadows::finish()
{
  state_->casters.finish();
  std::vector<glm::vec3> positions_ws;
  for_each_slot([&](ShadowSlot &slot) {
    update_for_casters(slot, state_->casters);
    positions_ws.push_back(slot.center_ws);
  });
  state_->casters.distances().keep_only(positions_ws, state_->casters.list());
  state_->casters.forget_meshes();
}

/**
 * Give the maps 16-bit depths if they may have them and all have a small error. Maps with 32 bits keep them, so that
 * no movement of the camera changes the format again and again. Maps that are fitted to depths do not, because a
 * picture must not depend on the pictures before it.
 */
void SceneShadows::choose_map_format()
{
  LayerArray &maps = state_->arrays[std::size_t(ShadowArrayId::Maps)];
  const bool has_long_maps = maps.texture() && maps.format() == gpu::Format::Depth32F;
  scene::Bounds surfaces_ws = bounds_ws_;
  surfaces_ws.extend(state_->casters.bounds_ws());
  const bool is_fitted = settings_.is_fitted_to_depth;
  const double error_max = is_fitted ? fitted_short_depth_error_max : short_depth_error_max;
  bool is_short = settings_.can_have_short_maps && (is_fitted || !has_long_maps);
  for_each_slot([&](const ShadowSlot &slot) {
    if (slot.place.given.array == ShadowArrayId::Maps && !slot.views.empty()) {
      // Other maps have longer depths, whose steps would add to the error of pictures of many samples.
      const bool has_fitted_depths = !slot.fits.empty() && !slot.fits.front().is_stable;
      is_short = is_short && (has_fitted_depths || !is_fitted) && short_depth_error(slot, surfaces_ws) <= error_max;
    }
  });
  const gpu::Format format = is_short ? gpu::Format::Depth16 : gpu::Format::Depth32F;
  const bool is_changed = format != maps.format();
  maps.set_format(format);
  for_each_slot([&](ShadowSlot &slot) {
    if (slot.place.given.array == ShadowArrayId::Maps) {
      slot.depth_half_step = is_short ? short_depth_half_step : 0.0F;
      slot.invalidate(is_changed ? ~0U : 0U);
    }
  });
}

template <typename Action>
void SceneShadows::for_each_cube(Action &&action)
{
  for (ShadowSlot &slot : state_->slots) {
    if (slot.place.given.array == ShadowArrayId::Cubes) {
      action(slot);
    }
  }
}

void SceneShadows::place_cubes(gpu::Device &device, const VisibleRange &visible)
{
  if (!settings_.is_fitted_to_depth) {
    return;
  }
  LayerMask placed = 0;
  LayerMask missing = 0;
  int end = 0;
  int planned = 0;
  for_each_cube([&](const ShadowSlot &slot) {
    const int layer_count = slot.index_of(slot.place.given.layer_count_max);
    placed |= slot.placed;
    missing |= needed_layers(slot, visible) & ~slot.placed;
    end = layer_count > 0 ? std::max(end, slot.place.first_layer + layer_count) : end;
    planned += slot.place.given.layer_count_max;
  });
  // With the gaps of removed lamps, the array can exceed the plan.
  const bool is_new = placed == 0 || end > planned;
  if (is_new || missing != 0) {
    // Lamps whose points move, and views that move, may need another face each time. If the first faces do not suffice,
    // all lamps get all, so that the array is created twice at most.
    end = 0;
    for_each_cube([&](ShadowSlot &slot) {
      const LayerMask now = is_new ? needed_layers(slot, visible) : ~0U;
      if (slot.placed != now || slot.place.first_layer != end) {
        slot.placed = now;
        slot.place.first_layer = end;
        slot.invalidate(~0U);
      }
      end += slot.placed_count();
    });
  }
  resize(device, ShadowArrayId::Cubes, end);
}

/** Assign layers to each map. A run keeps its layers unless it has to grow and the next layers are in use. */
void SceneShadows::place_maps(gpu::Device &device)
{
  if (map_count() == 0) {
    return;
  }
  choose_map_format();
  const auto place_all = [&](auto &&is_placed) {
    for_each_slot([&](ShadowSlot &slot) {
      if (slot.place.given.array == ShadowArrayId::Maps && is_placed(slot)) {
        const int first_layer = state_->map_runs.place({slot.lamp.key, slot.viewport}, int(slot.views.size()));
        if (first_layer != slot.place.first_layer) {
          slot.place.first_layer = first_layer;
          slot.invalidate(~0U);
        }
      }
    });
  };
  const auto grows = [&](const ShadowSlot &slot) {
    return int(slot.views.size()) > state_->map_runs.count_of({slot.lamp.key, slot.viewport});
  };
  // Place the runs that do not grow first, because they may release layers for those that grow.
  place_all([&](const ShadowSlot &slot) { return !grows(slot); });
  place_all(grows);
  if (state_->map_runs.end() > state_->plan.map_layers_max) {
    // With the gaps between runs, the array exceeds the limit. Place all runs again without gaps.
    state_->map_runs.clear();
    place_all([](const ShadowSlot & /*slot*/) { return true; });
  }
  resize(device, ShadowArrayId::Maps, state_->map_runs.end());
}

void SceneShadows::invalidate()
{
  for_each_slot([](ShadowSlot &slot) { slot.invalidate(~0U); });
  for (Shadows *viewport : viewports_) {
    viewport->is_block_written_ = false;
  }
}

Feature SceneShadows::features() const
{
  Feature features = Feature::None;
  for (const ShadowPlace &place : state_->plan.places) {
    features = features | place.technique->features(place.kind);
  }
  return features;
}

void SceneShadows::add_caster(const Caster &caster)
{
  state_->casters.add(caster);
}

const LayerArray &SceneShadows::array(ShadowArrayId id) const
{
  return state_->arrays[std::size_t(id)];
}

const gpu::Texture &SceneShadows::cubes() const
{
  return array(ShadowArrayId::Cubes).texture();
}

const gpu::Texture &SceneShadows::maps() const
{
  return array(ShadowArrayId::Maps).texture();
}

const gpu::Texture &SceneShadows::distance_cube() const
{
  return array(ShadowArrayId::DistanceCube).texture();
}

const OctahedralStore &SceneShadows::octahedral() const
{
  return state_->octahedral;
}

const std::vector<std::string> &SceneShadows::warnings() const
{
  return state_->plan.warnings;
}

std::uint64_t SceneShadows::triangles_visited() const
{
  return state_->casters.distances().triangles_visited();
}

std::size_t SceneShadows::cube_count() const
{
  return lamp_count(ShadowArrayId::Cubes);
}

std::size_t SceneShadows::map_count() const
{
  return lamp_count(ShadowArrayId::Maps);
}

std::size_t SceneShadows::esm_count() const
{
  return lamp_count(ShadowArrayId::DistanceCube);
}

std::size_t SceneShadows::lamp_count(ShadowArrayId id) const
{
  return std::size_t(
      std::ranges::count_if(state_->plan.places, [id](const ShadowPlace &place) { return place.given.array == id; }));
}

}  // namespace gnomon::eevee
