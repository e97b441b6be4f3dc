// SPDX-License-Identifier: MIT
#include "eevee_lights.hh"

#include "eevee_engine_data.hh"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>

namespace gnomon::eevee {

namespace {

/** Texels of a texture for \a count: the next power of two, so that edits and moving views seldom make a new one. */
int texture_width(std::size_t count, const gpu::Device &device)
{
  return std::min(int(std::bit_ceil(count)), device.limits().buffer_texels_max);
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

std::span<glm::vec4, LIGHT_TEXELS> light_texels_of(SharedData &shared, std::size_t light)
{
  return std::span(shared.light_texels).subspan(light * LIGHT_TEXELS).first<LIGHT_TEXELS>();
}

/** The light \a point.light at \a point, as a sample draws it. */
shared::LightData light_in_sample(const SharedData &shared, const LampPoint &point)
{
  shared::LightData light = light_at(shared.lamps.lights[std::size_t(point.light)], point);
  if (shared.is_light_left_out[std::size_t(point.light)]) {
    leave_out(light);
  }
  return light;
}

void write_light_block(SharedData &shared, gpu::Device &device)
{
  const Lamps &lamps = shared.lamps;
  shared::LightBlock block{};
  block.light_count = lamps.light_count();
  block.cube_light_count = lamps.cube_light_count;
  std::ranges::copy(lamps.lights, block.lights);
  device.update(shared.light_block, block);
  if (shared.light_shape_block) {
    shared::LightShapeBlock shapes{};
    std::ranges::copy(lamps.shapes, shapes.shapes);
    device.update(shared.light_shape_block, shapes);
  }
}

void write_light_texture(SharedData &shared, gpu::Device &device)
{
  const Lamps &lamps = shared.lamps;
  const int texel_count = LIGHT_TEXELS * lamps.light_count();
  const int width = texture_width(std::size_t(texel_count), device);
  if (!shared.light_texture || shared.light_texture.desc().width != width) {
    shared.light_texture = device.create_texture(
        {.name = "light_texture", .kind = gpu::TextureKind::Buffer, .format = gpu::Format::RGBA32F, .width = width});
  }
  if (!shared.light_sampler) {
    shared.light_sampler = device.create_sampler({.name = "light_sampler"});
  }
  shared.light_texels.resize(std::size_t(texel_count));
  for (std::size_t i = 0; i < lamps.lights.size(); i++) {
    set_texels(light_texels_of(shared, i), lamps.lights[i], lamps.shapes[i]);
  }
  device.upload(shared.light_texture, 0, std::as_bytes(std::span(shared.light_texels)));
  // Programs that show one light read it here.
  if (shared.light_block && shared.tinted_light) {
    device.update(shared.light_block, offsetof(shared::LightBlock, lights) + tinted_entry * sizeof(shared::LightData),
                  std::as_bytes(std::span(&lamps.lights[std::size_t(*shared.tinted_light)], 1)));
  }
}

}  // namespace

void make_lights(Data &data, gpu::Device &device, const Settings &settings, Feature read)
{
  SharedData &shared = *data.shared;
  const bool is_clustered = has(read, Feature::LightClusters);
  const bool has_block =
      has(read, Feature::Light) && (!is_clustered || settings.has_probe || shared.tinted_light.has_value());
  const auto keep = [&](gpu::Buffer &buffer, bool is_kept, const char *name, std::size_t size_bytes) {
    if (!is_kept) {
      buffer = {};
    }
    else if (!buffer) {
      buffer = device.create_buffer({name, gpu::BufferKind::Uniform, size_bytes});
      shared.are_lights_written = false;
    }
  };
  keep(shared.light_block, has_block, "light_block", sizeof(shared::LightBlock));
  keep(shared.light_shape_block, !is_clustered && has(read, Feature::LampShape), "light_shape_block",
       sizeof(shared::LightShapeBlock));
  if (!is_clustered) {
    shared.light_texture = {};
    shared.light_sampler = {};
    data.stl.clusters = {};
  }
  else if (!data.stl.clusters.block) {
    data.stl.clusters.block =
        device.create_buffer({"light_cluster_block", gpu::BufferKind::Uniform, sizeof(shared::LightClusterBlock)});
    data.stl.clusters.made.reset();
  }
  const bool is_written = shared.are_lights_written && (!is_clustered || shared.light_texture);
  if (!has(read, Feature::Light) || is_written) {
    return;
  }
  if (is_clustered) {
    write_light_texture(shared, device);
  }
  else {
    write_light_block(shared, device);
  }
  shared.are_lights_written = true;
}

void bind_lights(draw::ShadingGroup &group, const Data &data)
{
  const SharedData &shared = *data.shared;
  if (shared.light_block) {
    group.bind_uniform("light_block", shared.light_block);
  }
  if (shared.light_shape_block) {
    group.bind_uniform("light_shape_block", shared.light_shape_block);
  }
  if (shared.light_texture) {
    group.bind_texture("light_texture", shared.light_texture, shared.light_sampler);
    group.bind_uniform("light_cluster_block", data.stl.clusters.block);
    group.bind_texture_ref("light_lists", &data.stl.clusters.binding);
  }
}

int light_entry(const Data &data, int light, int entry)
{
  return has(data.stl.features, Feature::LightClusters) ? entry : light;
}

void write_light_entry(const Data &data, const SampledLampPoints &sampled, int light, int entry, gpu::CommandList &list)
{
  const SharedData &shared = *data.shared;
  if (!has(data.stl.features, Feature::LightClusters)) {
    return;
  }
  const auto point = std::ranges::find(sampled.points, light, &LampPoint::light);
  const shared::LightData value =
      point == sampled.points.end() ? shared.lamps.lights[std::size_t(light)] : light_in_sample(shared, *point);
  list.update(shared.light_block, offsetof(shared::LightBlock, lights) + std::size_t(entry) * sizeof(value),
              std::as_bytes(std::span(&value, 1)));
}

/** Write the members of `world_block` that change with each sample. */
static void write_sun_points(const SharedData &shared, const SampledLampPoints &sampled, gpu::CommandList &list)
{
  struct {
    int first_sun = 0;
    int sun_count = 0;
    std::array<shared::WorldSunPoint, std::size_t(WORLD_SUN_MAX) * WORLD_SUN_POINTS> points{};
  } values;
  static_assert(sizeof(values) == sizeof(shared::WorldBlock) - offsetof(shared::WorldBlock, first_sun));
  const std::vector<shared::WorldSunPoint> &points = sampled.sun_points;
  if (!shared.world.block || points.empty()) {
    return;
  }
  values.first_sun = sampled.first_sun;
  const bool is_left_out = shared.is_light_left_out[std::size_t(values.first_sun)];
  values.sun_count = is_left_out ? 0 : int(points.size()) / WORLD_SUN_POINTS;
  std::ranges::copy(points, values.points.begin());
  list.update(shared.world.block, offsetof(shared::WorldBlock, first_sun), std::as_bytes(std::span(&values, 1)));
}

void write_lamp_points(Data &data, const SampledLampPoints &sampled, gpu::Device &device, gpu::CommandList &list)
{
  const std::vector<LampPoint> &points = sampled.points;
  if (points.empty()) {
    return;
  }
  SharedData &shared = *data.shared;
  write_sun_points(shared, sampled, list);
  if (has(data.stl.features, Feature::LightClusters)) {
    for (const LampPoint &point : points) {
      const auto light = std::size_t(point.light);
      set_texels(light_texels_of(shared, light), light_in_sample(shared, point), shared.lamps.shapes[light]);
    }
    // The points are in the order of the lights.
    const std::size_t end = LIGHT_TEXELS * (std::size_t(points.back().light) + 1);
    device.upload(shared.light_texture, 0, std::as_bytes(std::span(shared.light_texels).first(end)));
    if (shared.tinted_light) {
      write_light_entry(data, sampled, *shared.tinted_light, tinted_entry, list);
    }
    return;
  }
  // The points are in the order of the lights. One write of the whole range costs less than one write for each point.
  const auto first = std::size_t(points.front().light);
  const auto end = std::size_t(points.back().light) + 1;
  std::vector<shared::LightData> &lights = data.stl.sampled_lights;
  lights.assign(shared.lamps.lights.begin() + std::ptrdiff_t(first), shared.lamps.lights.begin() + std::ptrdiff_t(end));
  for (const LampPoint &point : points) {
    lights[std::size_t(point.light) - first] = light_in_sample(shared, point);
  }
  list.update(shared.light_block, offsetof(shared::LightBlock, lights) + first * sizeof(shared::LightData),
              std::as_bytes(std::span(lights)));
}

void update_light_clusters(Data &data, draw::Viewport &viewport, const draw::View &view, gpu::CommandList &list)
{
  ViewClusters &clusters = data.stl.clusters;
  const SharedData &shared = *data.shared;
  const ViewClusters::Key key{view, viewport.drawn_size_px(), shared.reaches_revision};
  if (clusters.made == key && clusters.texture) {
    // Another viewport may have made the sampler anew.
    clusters.binding = {clusters.texture.id(), shared.light_sampler.id()};
    return;
  }
  clusters.made.reset();
  gpu::Device &device = viewport.device();
  clusters.lists.build(shared.lamps, view, viewport.drawn_size_px(), shared.bounds_ws,
                       std::size_t(device.limits().buffer_texels_max));
  list.update(clusters.block, 0, std::as_bytes(std::span(&clusters.lists.block(), 1)));
  const std::span<const float> values = clusters.lists.values();
  if (!clusters.texture || int(values.size()) > clusters.texture.desc().width) {
    clusters.texture = device.create_texture({.name = "light_lists",
                                              .kind = gpu::TextureKind::Buffer,
                                              .format = gpu::Format::R32F,
                                              .width = texture_width(values.size(), device)});
  }
  clusters.binding = {clusters.texture.id(), shared.light_sampler.id()};
  device.upload(clusters.texture, 0, std::as_bytes(values));
  clusters.made = key;
}

}  // namespace gnomon::eevee
