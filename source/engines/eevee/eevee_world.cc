// SPDX-License-Identifier: MIT
#include "eevee_world.hh"

#include "eevee_engine.hh"
#include "eevee_world_shared.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace gnomon::eevee {

static_assert(WORLD_SUN_MAX == render_scene::WorldLight::sun_max);

std::vector<scene::PlacedLamp> world_lamps(const render_scene::WorldLight &world, LampShading shading)
{
  std::vector<scene::PlacedLamp> lamps;
  for (const render_scene::WorldLight::Sun &sun : world.suns) {
    lamps.push_back(sun.lamp);
  }
  const bool has_directions = shading == LampShading::Point && !world.rest_directions.empty();
  for (int i = 0; has_directions && i < world_direction_count; i++) {
    scene::PlacedLamp &lamp = lamps.emplace_back();
    lamp.name = "world direction " + std::to_string(i + 1);
    lamp.kind = scene::LampKind::Sun;
    lamp.intensity = 1.0F;
    // The lamp covers the whole sphere, so that has_extent is true and LampPoints samples it.
    lamp.angle = float(2.0 * std::numbers::pi);
  }
  for (std::size_t i = 0; i < lamps.size(); i++) {
    lamps[i].node.index = world_node_first + std::uint32_t(i);
  }
  return lamps;
}

void update_world(WorldResources &resources, gpu::Device &device, const render_scene::RenderScene &scene,
                  Feature features, const Settings &settings)
{
  using render_scene::WorldLight;
  const int sample_count = settings.planned_sample_count();
  const bool is_black = !settings.light.has(LightPart::Kind::World);
  if (std::exchange(resources.is_black, is_black) != is_black ||
      std::exchange(resources.revision, scene.world_revision()) != scene.world_revision() ||
      std::exchange(resources.sample_count, sample_count) != sample_count || !has(features, Feature::World)) {
    resources.block = {};
    resources.levels = {};
  }
  if (!has(features, Feature::World)) {
    return;
  }
  const WorldLight &world = *scene.world();
  if (!resources.block) {
    shared::WorldBlock block{};
    for (std::size_t i = 0; i < world.harmonics.size() && !is_black; i++) {
      block.harmonics[i] = glm::vec4(world.harmonics[i], 0.0F);
    }
    block.is_sampled = sample_count > 1 ? 1 : 0;
    const double lobe_share = world_lobe_directions / (double(world_direction_count) * sample_count);
    block.alpha_sampled = float(std::sqrt(std::min(lobe_share, 1.0)));
    resources.block = device.create_buffer({"world_block", gpu::BufferKind::Uniform, sizeof(block)});
    device.update(resources.block, block);
  }
  if (!has(features, Feature::Specular)) {
    resources.levels = {};
  }
  else if (!resources.levels) {
    resources.levels = device.create_texture({.name = "world_levels",
                                              .kind = gpu::TextureKind::Array,
                                              .format = gpu::Format::RGBA32F,
                                              .width = WorldLight::size.x,
                                              .height = WorldLight::size.y,
                                              .layers = WORLD_LEVEL_COUNT});
    resources.sampler =
        device.create_sampler({.name = "world_sampler", .filter = gpu::Filter::Linear, .wrap_u = gpu::Wrap::Repeat});
    const auto levels = render_scene::prefiltered(world.rest, WORLD_LEVEL_COUNT);
    for (std::size_t i = 0; i < levels.size(); i++) {
      std::vector<glm::vec4> texels;
      texels.reserve(levels[i].size());
      for (const glm::vec3 &texel : levels[i]) {
        texels.emplace_back(is_black ? glm::vec3(0.0F) : texel, 1.0F);
      }
      device.upload(resources.levels, int(i), std::as_bytes(std::span(texels)));
    }
  }
}

bool has_background(const Settings &settings, const render_scene::RenderScene &scene)
{
  return settings.light.has(LightPart::Kind::World) &&
         (settings.background.kind == Background::Kind::Color ||
          (settings.background.kind == Background::Kind::World && scene.scene().world()));
}

glm::vec3 background_color(const Settings &settings, const render_scene::RenderScene &scene)
{
  return settings.background.kind == Background::Kind::Color
             ? settings.background.color
             : scene.scene().world()->strength * scene.scene().world()->color;
}

/** The texels of \a picture, rows from the bottom. Takes every n-th texel if an edge is longer than \a size_max. */
static std::pair<glm::ivec2, std::vector<glm::vec4>> texels_of(const scene::WorldPicture &picture, int size_max)
{
  const int step = (std::max(picture.width, picture.height) + size_max - 1) / size_max;
  const glm::ivec2 size((picture.width + step - 1) / step, (picture.height + step - 1) / step);
  std::vector<glm::vec4> texels;
  texels.reserve(std::size_t(size.x) * std::size_t(size.y));
  for (int y = size.y - 1; y >= 0; y--) {
    for (int x = 0; x < size.x; x++) {
      texels.emplace_back(picture.at(x * step, y * step), 1.0F);
    }
  }
  return {size, std::move(texels)};
}

void update_world_picture(WorldResources &resources, gpu::Device &device, const render_scene::RenderScene &scene,
                          const Settings &settings)
{
  const bool is_shown =
      settings.background.kind == Background::Kind::World && scene.scene().world() && scene.scene().world()->picture;
  if (!is_shown || resources.picture_revision != scene.scene().world_revision()) {
    resources.picture = {};
  }
  if (!is_shown || resources.picture) {
    return;
  }
  const auto [size, texels] = texels_of(*scene.scene().world()->picture, device.limits().texture_size_max);
  resources.picture = device.create_texture(
      {.name = "world_picture", .format = gpu::Format::RGBA32F, .width = size.x, .height = size.y});
  resources.picture_sampler = device.create_sampler(
      {.name = "world_picture_sampler", .filter = gpu::Filter::Linear, .wrap_u = gpu::Wrap::Repeat});
  device.upload(resources.picture, 0, std::as_bytes(std::span(texels)));
  resources.picture_revision = scene.scene().world_revision();
}

}  // namespace gnomon::eevee
