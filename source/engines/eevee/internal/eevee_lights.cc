// SPDX-License-Identifier: MIT
#include "internal/eevee_lights.hh"
#include "internal/eevee_resource_report.hh"

#include "eevee_settings.hh"
#include "internal/eevee_material_variants.hh"
#include "shadows/scene_shadows.hh"
#include "shadows/shadow_plan.hh"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <iterator>
#include <utility>

namespace gnomon::eevee {

namespace {

/** Index in Lamps::lights of the first sun with shadow maps. */
std::optional<int> first_sun_with_maps(const Lamps &lamps)
{
  for (int i = 0; i < lamps.light_count(); i++) {
    const shared::LightData &light = lamps.lights[std::size_t(i)];
    if (light.kind == LIGHT_SUN && light.shadow_kind == SHADOW_MAP) {
      return i;
    }
  }
  return std::nullopt;
}

void set_texels(std::span<glm::vec4, LIGHT_TEXELS> texels, const shared::LightData &light,
                const shared::LightShape &shape)
{
  texels[0] = glm::vec4(light.position_ws, float(light.kind));
  texels[1] = glm::vec4(light.color, light.radius_sq);
  texels[2] = glm::vec4(light.forward_ws, light.range_inv_sq);
  texels[3] =
      glm::vec4(light.spot_drop_outer, light.spot_inv_width, float(light.shadow_kind), float(light.shadow_index));
  texels[4] = glm::vec4(shape.axis_x_ws, shape.extent);
  texels[5] = glm::vec4(shape.axis_y_ws, shape.highlight_points_share);
  texels[6] = glm::vec4(shape.center_ws, shape.highlight_extent);
}

std::span<glm::vec4, LIGHT_TEXELS> texels_of(std::vector<glm::vec4> &texels, std::size_t light)
{
  return std::span(texels).subspan(light * LIGHT_TEXELS).first<LIGHT_TEXELS>();
}

}  // namespace

/** First of PlannedLights::placed that are of emissive surfaces, of the world, and further points of the surfaces. */
struct SceneLights::PlacedSections {
  std::size_t emission = 0;
  std::size_t world = 0;
  std::size_t further = 0;

  [[nodiscard]] LightComponent::Kind component_of(std::size_t lamp) const
  {
    return lamp < emission                   ? LightComponent::Kind::Lamp
           : lamp < world || lamp >= further ? LightComponent::Kind::Emission
                                             : LightComponent::Kind::World;
  }
};

int light_texture_width(std::size_t count, const gpu::Device &device)
{
  return std::min(int(std::bit_ceil(count)), device.limits().buffer_texels_max);
}

bool SceneLights::sync(const render_scene::RenderScene &scene, const Settings &settings,
                       std::uint64_t settings_revision, std::uint64_t shaders_revision, SceneEmission &emission,
                       SceneShadows &shadows)
{
  emission.update(scene, settings.emissive_points() > 0);
  const Key key{scene.lamps_revision(), scene.objects().revision(), scene.passes_revision(),
                settings_revision,      shaders_revision,           shadows.viewports_revision(),
                emission.revision(),    scene.content_revision()};
  if (synced_ == key) {
    return false;
  }
  if (synced_ && synced_->shaders != key.shaders) {
    // Other programs draw other shadows.
    shadows.invalidate();
  }
  synced_.reset();
  is_written_ = false;
  revision_++;
  plan_.emission = emission.surfaces();
  make_plan(scene, settings, shadows);
  synced_ = key;
  return true;
}

SceneLights::PlacedSections SceneLights::place_lights(const render_scene::RenderScene &scene, const Settings &settings,
                                                      LampShading shading)
{
  const std::shared_ptr<const render_scene::WorldLight> &world = scene.world();
  std::vector<scene::PlacedLamp> &placed = plan_.placed;
  Lamps &lamps = plan_.lamps;
  PlacedSections first;
  placed.assign(scene.lamps().begin(), scene.lamps().end());
  for (scene::PlacedLamp &lamp : placed) {
    lower_range(lamp, settings.light_threshold);
  }
  first.emission = placed.size();
  const int emissive_count = plan_.emission ? settings.emissive_points() : 0;
  std::ranges::copy(emission_lamps(emissive_count, scene.bounds()), std::back_inserter(placed));
  if (shading == LampShading::Whole) {
    for (scene::PlacedLamp &lamp : std::span(placed).subspan(first.emission)) {
      lamp.radius = 0.0F;
    }
  }
  first.world = placed.size();
  if (world) {
    std::ranges::copy(world_lamps(*world, world_.directions().count), std::back_inserter(placed));
  }
  first.further = placed.size();
  const int device_most = scene.device().limits().buffer_texels_max / LIGHT_TEXELS;
  const auto most = std::size_t(std::clamp(device_most, LIGHT_MAX, LIGHT_COUNT_MAX));
  Lamps made = make_lamps(placed, shading, most);
  if (shading == LampShading::Whole && emissive_count > 0) {
    const auto further = std::size_t(points_per_shadow * emissive_count);
    if (made.lights.size() + further <= most) {
      std::ranges::copy(further_emission_lamps(emissive_count, int(further)), std::back_inserter(placed));
      add_surface_points(made, placed, first.further);
    }
  }
  const bool has_reaches = made.reaches == lamps.reaches && made.cube_light_count == lamps.cube_light_count &&
                           made.cube_everywhere_count == lamps.cube_everywhere_count;
  reaches_revision_ += has_reaches ? 0 : 1;
  lamps = std::move(made);
  if (lamps.local_count() >= settings.clustered_lamps_min || lamps.light_count() > LIGHT_MAX) {
    lamps.features = lamps.features | Feature::LightClusters;
  }
  if (world) {
    lamps.features = lamps.features | Feature::Light | Feature::World;
    set_kind(lamps, first.world + world->suns.size(), placed.size(), LIGHT_WORLD);
  }
  set_kind(lamps, first.emission, first.world, LIGHT_SURFACE);
  set_kind(lamps, first.further, placed.size(), LIGHT_SURFACE);
  return first;
}

void SceneLights::fix_surface_points(const PlacedSections &first, const Settings &settings)
{
  std::vector<scene::PlacedLamp> &placed = plan_.placed;
  Lamps &lamps = plan_.lamps;
  for (std::size_t i = 0; i < lamps.lights.size(); i++) {
    const std::size_t lamp = lamps.lamp_index[i];
    if (lamps.lights[i].kind != LIGHT_SURFACE) {
      continue;
    }
    const std::size_t begin = lamp < first.world ? first.emission : first.further;
    const std::size_t end = lamp < first.world ? first.world : placed.size();
    const LampPoint point =
        emissive_point(*plan_.emission, std::uint32_t(lamp - begin), lamp_stream(settings.seed, first.emission),
                       int(end - begin), settings.planned_sample_count());
    placed[lamp].world_from_lamp = glm::dmat4(point.world_from_lamp);
    lamps.lights[i] = light_at(lamps.lights[i], point);
  }
}

void SceneLights::select_lights(const PlacedSections &first, const LightComponent &selected)
{
  plan_.is_left_out.clear();
  for (int i = 0; i < plan_.lamps.light_count(); i++) {
    const std::size_t lamp = plan_.lamps.lamp_index[std::size_t(i)];
    const bool is_kept = selected.has(first.component_of(lamp)) &&
                         (selected.kind != LightComponent::Kind::Lamp || selected.lamp == lamp);
    plan_.is_left_out.push_back(!is_kept);
    if (!is_kept) {
      leave_out(plan_.lamps.lights[std::size_t(i)]);
    }
  }
}

void SceneLights::make_plan(const render_scene::RenderScene &scene, const Settings &settings, SceneShadows &shadows)
{
  const int sample_count = settings.planned_sample_count();
  const LampShading shading = sample_count > 1 ? LampShading::Point : LampShading::Whole;
  const scene::Bounds &bounds_ws = scene.bounds();
  const PlacedSections first = place_lights(scene, settings, shading);
  auto &[placed, lamps, is_left_out, points, tinted, planned_bounds_ws, emission] = plan_;
  if (shading == LampShading::Whole) {
    fix_surface_points(first, settings);
  }
  else {
    set_highlights(lamps, placed, first.emission, sample_count, bounds_ws);
  }
  ShadowSettings shadow = settings.shadow;
  // These surfaces receive shadows, and the depths that are read back do not have them.
  shadow.is_fitted_to_depth &= !has_surfaces_without_depth(scene.scene());
  shadows.sync(scene.device().limits(), shadow_lamps(placed, lamps, shading), bounds_ws, lamps.lights, shadow);
  planned_bounds_ws = bounds_ws;
  points = shading == LampShading::Point
               ? LampPoints(placed, lamps, bounds_ws.is_empty() ? glm::vec3(0.0F) : bounds_ws.center(), scene.world(),
                            world_.directions(), sample_count, emission, emission ? settings.emissive_points() : 0)
               : LampPoints();
  select_lights(first, settings.light);
  tinted = settings.has_cascade_tint ? first_sun_with_maps(lamps) : std::nullopt;
}

shared::LightData SceneLights::light_in_sample(const LampPoint &point) const
{
  shared::LightData light = light_at(plan_.lamps.lights[std::size_t(point.light)], point);
  if (plan_.is_left_out[std::size_t(point.light)]) {
    leave_out(light);
  }
  return light;
}

void SceneLights::write_block(gpu::Device &device)
{
  const Lamps &lamps = plan_.lamps;
  shared::LightBlock block{};
  block.light_count = lamps.light_count() - lamps.surface_point_count;
  block.cube_light_count = lamps.cube_light_count;
  block.surface_point_count = lamps.surface_point_count;
  std::ranges::copy(lamps.lights, block.lights);
  device.update(block_, block);
  if (shape_block_) {
    shared::LightShapeBlock shapes{};
    std::ranges::copy(lamps.shapes, shapes.shapes);
    device.update(shape_block_, shapes);
  }
}

void SceneLights::write_texture(gpu::Device &device)
{
  const Lamps &lamps = plan_.lamps;
  const int texel_count = LIGHT_TEXELS * lamps.light_count();
  const int width = light_texture_width(std::size_t(texel_count), device);
  if (!texture_ || texture_.desc().width != width) {
    texture_ = device.create_texture(
        {.name = "light_texture", .kind = gpu::TextureKind::Buffer, .format = gpu::Format::RGBA32F, .width = width});
  }
  if (!sampler_) {
    sampler_ = device.create_sampler({.name = "light_sampler"});
  }
  texels_.resize(std::size_t(texel_count));
  for (std::size_t i = 0; i < lamps.lights.size(); i++) {
    set_texels(texels_of(texels_, i), lamps.lights[i], lamps.shapes[i]);
  }
  device.upload(texture_, 0, std::as_bytes(std::span(texels_)));
  // Programs that show one light read it here.
  if (block_ && plan_.tinted) {
    device.update(block_, offsetof(shared::LightBlock, lights) + tinted_entry * sizeof(shared::LightData),
                  std::as_bytes(std::span(&lamps.lights[std::size_t(*plan_.tinted)], 1)));
  }
}

void SceneLights::make(gpu::Device &device, const Settings &settings, Feature read)
{
  const bool is_clustered = has(read, Feature::LightClusters);
  const bool has_block = has(read, Feature::Light) && (!is_clustered || settings.has_probe || plan_.tinted.has_value());
  const auto keep = [&](gpu::Buffer &buffer, bool is_kept, const char *name, std::size_t size_bytes) {
    if (!is_kept) {
      buffer = {};
    }
    else if (!buffer) {
      buffer = device.create_buffer({name, gpu::BufferKind::Uniform, size_bytes});
      is_written_ = false;
    }
  };
  keep(block_, has_block, "light_block", sizeof(shared::LightBlock));
  keep(shape_block_, !is_clustered && has(read, Feature::LampShape), "light_shape_block",
       sizeof(shared::LightShapeBlock));
  if (!is_clustered) {
    texture_ = {};
    sampler_ = {};
  }
  if (!has(read, Feature::Light) || (is_written_ && (!is_clustered || texture_))) {
    return;
  }
  if (is_clustered) {
    write_texture(device);
  }
  else {
    write_block(device);
  }
  is_written_ = true;
}

void SceneLights::bind(draw::ShadingGroup &group) const
{
  if (block_) {
    group.bind_uniform("light_block", block_);
  }
  if (shape_block_) {
    group.bind_uniform("light_shape_block", shape_block_);
  }
  if (texture_) {
    group.bind_texture("light_texture", texture_, sampler_);
  }
}

void SceneLights::write_entry(const SampledLampPoints &sampled, int light, int entry, gpu::CommandList &list) const
{
  if (!plan_.is_clustered()) {
    return;
  }
  const auto point = std::ranges::find(sampled.points, light, &LampPoint::light);
  const shared::LightData value =
      point == sampled.points.end() ? plan_.lamps.lights[std::size_t(light)] : light_in_sample(*point);
  list.update(block_, offsetof(shared::LightBlock, lights) + std::size_t(entry) * sizeof(value),
              std::as_bytes(std::span(&value, 1)));
}

void SceneLights::write_points(const SampledLampPoints &sampled, gpu::Device &device, gpu::CommandList &list)
{
  const std::vector<LampPoint> &points = sampled.points;
  if (points.empty()) {
    return;
  }
  if (!sampled.sun_points.empty()) {
    world_.write_suns(sampled.sun_points, sampled.first_sun, plan_.is_left_out[std::size_t(sampled.first_sun)], list);
  }
  if (plan_.is_clustered()) {
    for (const LampPoint &point : points) {
      const auto light = std::size_t(point.light);
      set_texels(texels_of(texels_, light), light_in_sample(point), plan_.lamps.shapes[light]);
    }
    // The points are in the order of the lights.
    const std::size_t end = LIGHT_TEXELS * (std::size_t(points.back().light) + 1);
    device.upload(texture_, 0, std::as_bytes(std::span(texels_).first(end)));
    if (plan_.tinted) {
      write_entry(sampled, *plan_.tinted, tinted_entry, list);
    }
    return;
  }
  // The points are in the order of the lights. One write of the whole range costs less than one write for each point.
  const auto first = std::size_t(points.front().light);
  const auto end = std::size_t(points.back().light) + 1;
  const std::vector<shared::LightData> &lights = plan_.lamps.lights;
  sampled_.assign(lights.begin() + std::ptrdiff_t(first), lights.begin() + std::ptrdiff_t(end));
  for (const LampPoint &point : points) {
    sampled_[std::size_t(point.light) - first] = light_in_sample(point);
  }
  list.update(block_, offsetof(shared::LightBlock, lights) + first * sizeof(shared::LightData),
              std::as_bytes(std::span(sampled_)));
}

void SceneLights::report(ResourceReport &report) const
{
  const std::string count = fmt::format("{} lights", plan_.lamps.light_count());
  const char *elsewhere = "the lights are in light_texture";
  report.add_target(texture_, "light_texture", count, report.why_no_feature(Feature::LightClusters));
  report.add_block(block_, "light_block", count, plan_.is_clustered() ? elsewhere : "no lamp gives light");
  report.add_block(shape_block_, "light_shape_block", "extents and axes of lamps",
                   plan_.is_clustered() ? elsewhere : report.why_no_feature(Feature::LampShape));
}

}  // namespace gnomon::eevee
