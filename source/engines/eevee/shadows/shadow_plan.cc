// SPDX-License-Identifier: MIT
#include "shadow_plan.hh"

#include "shadow_technique.hh"

#include "eevee_lamp_points.hh"

#include "eevee_esm_shared.h"
#include "eevee_octahedral_shared.h"
#include "eevee_shadow_shared.h"

#include <fmt/ranges.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::eevee {

float ShadowLamp::shadow_range() const
{
  constexpr float infinity = std::numeric_limits<float>::infinity();
  if (kind == scene::LampKind::Sun) {
    return infinity;
  }
  return std::min(range > 0.0F ? range : infinity, shadow.clip_end.value_or(infinity));
}

std::vector<ShadowLamp> shadow_lamps(std::span<const scene::PlacedLamp> placed, const Lamps &lamps, LampShading shading)
{
  std::vector<ShadowLamp> result;
  for (int i = 0; i < lamps.light_count(); i++) {
    const scene::PlacedLamp &lamp = placed[lamps.lamp_index[std::size_t(i)]];
    const shared::LightShape &shape = lamps.shapes[std::size_t(i)];
    const bool is_area = lamp.kind == scene::LampKind::Area;
    const float longest = std::max(glm::length(shape.axis_x_ws), glm::length(shape.axis_y_ws));
    const bool is_sampled = shading == LampShading::Point && has_extent(lamp);
    constexpr float smooth_angle = 0.2F;
    result.push_back({.key = lamp.node.key(),
                      .light = i,
                      .name = lamp.name,
                      .kind = lamp.kind,
                      .world_from_lamp = glm::mat4(lamp.world_from_lamp),
                      .spot_outer_angle = widest_half_angle(lamp),
                      .range = lamp.range,
                      .shadow = lamp.shadow,
                      .extent = is_area && shape.extent > 0.0F ? longest : shape.extent,
                      .is_sampled = is_sampled,
                      .is_smooth = is_sampled && lamp.kind == scene::LampKind::Sun && lamp.angle > smooth_angle});
  }
  // Lamps::lights has another order.
  std::ranges::sort(result, {}, [&](const ShadowLamp &lamp) { return lamps.lamp_index[std::size_t(lamp.light)]; });
  return result;
}

scene::ShadowKind shadow_kind(scene::LampKind lamp, std::optional<scene::ShadowKind> asked,
                              const ShadowSettings &settings)
{
  using scene::ShadowKind;
  if (settings.kind == ShadowKind::None || lamp == scene::LampKind::Hemi) {
    return ShadowKind::None;
  }
  const ShadowKind kind = asked.value_or(settings.kind);
  const bool is_exponential = kind == ShadowKind::Esm || kind == ShadowKind::Evsm;
  return is_exponential && lamp == scene::LampKind::Sun ? ShadowKind::Pcf : kind;
}

scene::ShadowKind shadow_kind(const scene::Lamp &lamp, const ShadowSettings &settings)
{
  return shadow_kind(lamp.kind, lamp.shadow.kind, settings);
}

namespace {

constexpr int size_px_min = 16;
constexpr int octahedral_px_min = 4;

constexpr std::size_t index_of(ShadowArrayId array)
{
  return std::size_t(array);
}

/** \a request with its sizes multiplied by \a scale, but not reduced below the minimum sizes. */
ShadowRequest scaled(ShadowRequest request, float scale)
{
  const auto lowered = [scale](int size, int least) {
    return std::max(int(float(size) * scale), std::min(size, least));
  };
  request.size_px = lowered(request.size_px, size_px_min);
  request.octahedral_px = lowered(request.octahedral_px, octahedral_px_min);
  return request;
}

/** Inputs of a plan. */
struct Conditions {
  std::span<const ShadowLamp> lamps;
  const ShadowSettings &settings;
  const gpu::Limits &device_limits;
  int viewport_count = 1;
};

/** Maximum number of layers of one lamp in its array, over all viewports. */
int layers_max(const ShadowPlace &place, const Conditions &conditions)
{
  return place.given.layer_count_max * (place.technique->follows_view() ? conditions.viewport_count : 1);
}

/** Device memory of \a places if their sizes are multiplied by \a scale, bytes. */
std::size_t bytes_needed(const std::vector<ShadowPlace> &places, float scale, const Conditions &conditions)
{
  std::array<std::size_t, shadow_array_count> edges{};
  std::array<std::size_t, shadow_array_count> layers{};
  std::size_t octahedral_edge = 0;
  std::size_t octahedral_texel_bytes = 0;
  std::size_t octahedral_layers = 0;
  for (const ShadowPlace &place : places) {
    const ShadowRequest request = scaled(place.given, scale);
    const std::size_t array = index_of(request.array);
    edges[array] = std::max(edges[array], std::size_t(request.size_px));
    layers[array] += std::size_t(layers_max(place, conditions));
    if (request.octahedral_px > 0) {
      octahedral_edge = std::max(octahedral_edge, std::size_t(request.octahedral_px + 2 * ESM_BORDER));
      octahedral_texel_bytes = std::max(octahedral_texel_bytes, std::size_t(request.octahedral_texel_bytes));
      octahedral_layers++;
    }
  }
  // All lamps with octahedral layers share one temporary cube.
  std::size_t &cube_layers = layers[index_of(ShadowArrayId::DistanceCube)];
  cube_layers = std::min<std::size_t>(cube_layers, 6);
  std::size_t bytes = 0;
  for (std::size_t i = 0; i < shadow_array_count; i++) {
    bytes += edges[i] * edges[i] * layers[i] * sizeof(float);
  }
  // All octahedral layers count as 32-bit layers. A separable filter needs two temporary textures.
  octahedral_layers += conditions.settings.esm.kernel == EsmKernel::Separable ? 2 : 0;
  return bytes + octahedral_edge * octahedral_edge * octahedral_texel_bytes * octahedral_layers;
}

void warn_of_settings_without_effect(const ShadowLamp &lamp, const ShadowSettings &settings,
                                     std::vector<std::string> &warnings)
{
  const scene::ShadowKind kind = lamp.shadow.kind.value_or(settings.kind);
  if (kind == scene::ShadowKind::Evsm && lamp.shadow.esm_format == scene::EsmFormat::Half) {
    warnings.push_back(fmt::format("lamp '{}': evsm is stored in 32 bits; esm_format 16f does nothing", lamp.name));
  }
  if (lamp.kind != scene::LampKind::Sun) {
    return;
  }
  if (kind == scene::ShadowKind::Esm || kind == scene::ShadowKind::Evsm) {
    warnings.push_back(
        fmt::format("lamp '{}': exponential shadows are for point lamps and spots; it has pcf", lamp.name));
  }
  if (lamp.shadow.clip_start || lamp.shadow.clip_end) {
    warnings.push_back(
        fmt::format("lamp '{}': a sun is at no distance; clip_start and clip_end do nothing", lamp.name));
  }
}

/** Reduce the sizes of \a plan, or remove its last places, until it fits into ShadowSettings::memory_bytes_max. */
void fit_memory(ShadowPlan &plan, const Conditions &conditions)
{
  const auto needs = [&](float scale) { return bytes_needed(plan.places, scale, conditions); };
  const std::size_t most = conditions.settings.memory_bytes_max;
  const std::size_t needed = needs(1.0F);
  if (needed <= most) {
    return;
  }
  float scale = float(std::sqrt(double(most) / double(needed)));
  std::vector<std::string> lost;
  if (needs(0.0F) <= most) {
    // Borders and minimum sizes do not scale, so that the square root may be too large. Find the scale by bisection.
    float high = scale;
    float low = needs(scale) <= most ? scale : 0.0F;
    for (int i = 0; i < 24 && low < high; i++) {
      const float middle = 0.5F * (low + high);
      (needs(middle) <= most ? low : high) = middle;
    }
    scale = low;
  }
  plan.limits.push_back(
      fmt::format("the shadows of {} lamps need {:.1f} MiB, and may take {:.1f}: their sizes are lowered to {:.0f} %",
                  plan.places.size(), double(needed) / 0x1p20, double(most) / 0x1p20, 100.0F * scale));
  while (needs(scale) > most) {
    lost.push_back(conditions.lamps[plan.places.back().lamp].name);
    plan.places.pop_back();
  }
  for (ShadowPlace &place : plan.places) {
    place.given = scaled(place.given, scale);
  }
  if (!lost.empty()) {
    plan.limits.push_back(fmt::format("{} lamps lost their shadow, as {:.1f} MiB hold no more of {} texels: {}",
                                      lost.size(), double(most) / 0x1p20, size_px_min, listed(lost)));
  }
}

/** Assign layers to cubes, and compute map_layers_max. */
void place_layers(ShadowPlan &plan, const Conditions &conditions)
{
  const auto owner = [&](const ShadowPlace &place) { return LayerOwner{conditions.lamps[place.lamp].key}; };
  std::array<std::size_t, shadow_array_count> layer_bytes{};
  std::array<int, shadow_array_count> layers{};
  std::vector<LayerOwner> cubes;
  for (const ShadowPlace &place : plan.places) {
    const std::size_t array = index_of(place.given.array);
    const auto edge = std::size_t(place.given.size_px);
    layer_bytes[array] = std::max(layer_bytes[array], edge * edge * sizeof(float));
    layers[array] += layers_max(place, conditions);
    if (place.given.array == ShadowArrayId::Cubes) {
      cubes.push_back(owner(place));
    }
  }
  plan.cubes.keep_only(cubes);
  const auto place_cubes = [&] {
    for (ShadowPlace &place : plan.places) {
      if (place.given.array == ShadowArrayId::Cubes) {
        place.first_layer = plan.cubes.place(owner(place), place.given.layer_count_max);
      }
    }
  };
  place_cubes();
  // Memory that the limit leaves for gaps.
  const std::size_t bytes = bytes_needed(plan.places, 1.0F, conditions);
  const std::size_t most = conditions.settings.memory_bytes_max;
  std::size_t spare_bytes = most - std::min(bytes, most);
  std::size_t gap_bytes = std::size_t(plan.cubes.end() - layers[0]) * layer_bytes[0];
  if (plan.cubes.end() > conditions.device_limits.array_layers_max || gap_bytes > spare_bytes) {
    plan.cubes.clear();
    place_cubes();
    gap_bytes = 0;
  }
  spare_bytes -= gap_bytes;
  const std::size_t map_bytes = std::max<std::size_t>(layer_bytes[index_of(ShadowArrayId::Maps)], 1);
  const int map_layers = layers[index_of(ShadowArrayId::Maps)];
  const int spare_layers = std::max(conditions.device_limits.array_layers_max - map_layers, 0);
  plan.map_layers_max = map_layers + int(std::min(spare_bytes / map_bytes, std::size_t(spare_layers)));
}

/** Set ShadowPlan::places, without their layers, and ShadowPlan::limits of lamps that the device does not allow. */
void add_places(ShadowPlan &plan, const Conditions &conditions)
{
  const auto &[lamps, settings, device_limits, viewport_count] = conditions;
  const std::array<int, shadow_array_count> entries_max = {
      std::min(SHADOW_CUBE_MAX, device_limits.array_layers_max / 6),
      // Conservative: this assumes that all maps follow the view, so that each viewport has its own layers.
      std::min(SHADOW_MAP_MAX, device_limits.array_layers_max / std::max(viewport_count, 1)),
      std::min(ESM_MAX, device_limits.array_layers_max)};
  std::array<int, shadow_array_count> entries{};
  std::vector<std::string> lost;
  std::vector<std::string> too_large;
  for (std::size_t i = 0; i < lamps.size(); i++) {
    const ShadowLamp &lamp = lamps[i];
    ShadowPlace place{.lamp = i, .kind = shadow_kind(lamp.kind, lamp.shadow.kind, settings)};
    if (place.kind == scene::ShadowKind::None) {
      continue;
    }
    warn_of_settings_without_effect(lamp, settings, plan.warnings);
    place.technique = &technique_of(lamp, place.kind);
    place.given = place.technique->request(lamp, place.kind, settings);
    if (lamp.is_sampled && !lamp.shadow.size) {
      place.given.size_px = std::max(place.given.size_px / (lamp.is_smooth ? 4 : 2), 1);
    }
    const std::size_t array = index_of(place.given.array);
    if (entries[array] + place.given.entry_count > entries_max[array]) {
      lost.push_back(lamp.name);
      continue;
    }
    if (place.given.size_px < 1) {
      throw gpu::Error("lamp '{}': size {} px of its shadow is not at least 1", lamp.name, place.given.size_px);
    }
    if (place.given.size_px > device_limits.texture_size_max) {
      too_large.push_back(lamp.name);
      place.given.size_px = device_limits.texture_size_max;
    }
    place.entry = entries[array];
    entries[array] += place.given.entry_count;
    place.first_layer = place.given.array == ShadowArrayId::Maps ? -1 : 0;
    place.index = plan.places.size();
    plan.places.push_back(place);
  }
  if (!lost.empty()) {
    plan.limits.push_back(
        fmt::format("{} lamps lost their shadow, as {} cubes, {} maps and {} exponential maps are the most: {}",
                    lost.size(), entries_max[0], entries_max[1], entries_max[2], listed(lost)));
  }
  if (!too_large.empty()) {
    plan.limits.push_back(fmt::format("the shadow size of {} lamps is {} texels, as this device takes no more: {}",
                                      too_large.size(), device_limits.texture_size_max, listed(too_large)));
  }
}

/** Set ShadowPlace::edge_max_px. */
void set_largest_edges(ShadowPlan &plan, const Conditions &conditions)
{
  for (ShadowPlace &place : plan.places) {
    const ShadowRequest &given = place.given;
    const bool is_alone =
        conditions.viewport_count <= 1 && std::ranges::count_if(plan.places, [&](const ShadowPlace &other) {
                                            return other.given.array == given.array;
                                          }) == 1;
    const bool is_larger = is_alone && given.can_have_larger_layers;
    place.edge_max_px = is_larger ? std::min(int(given.size_px * std::sqrt(double(given.layer_count_max))),
                                             conditions.device_limits.texture_size_max)
                                  : given.size_px;
  }
}

}  // namespace

ShadowPlan plan_shadows(std::span<const ShadowLamp> lamps, const ShadowSettings &settings,
                        const gpu::Limits &device_limits, const ShadowPlan &previous, int viewport_count)
{
  const Conditions conditions{lamps, settings, device_limits, viewport_count};
  ShadowPlan plan;
  plan.cubes = previous.cubes;
  add_places(plan, conditions);
  fit_memory(plan, conditions);
  set_largest_edges(plan, conditions);
  place_layers(plan, conditions);
  return plan;
}

}  // namespace gnomon::eevee
