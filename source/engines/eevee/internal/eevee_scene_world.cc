// SPDX-License-Identifier: MIT
#include "internal/eevee_scene_world.hh"

#include "eevee_settings.hh"
#include "internal/eevee_resource_report.hh"
#include "internal/eevee_world_occlusion.hh"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>

namespace gnomon::eevee {

static_assert(WORLD_SUN_MAX == render_scene::WorldLight::sun_max);

SceneWorld::SceneWorld() = default;
SceneWorld::~SceneWorld() = default;

void SceneWorld::sync_occlusion(const render_scene::RenderScene &scene, const Settings &settings)
{
  const bool is_sampled = settings.planned_sample_count() > 1;
  const bool is_traced = has_world_occlusion(settings, scene);
  const OcclusionKey key{scene.world_revision(),
                         is_traced ? scene.objects().revision() : 0,
                         is_traced ? scene.passes_revision() : 0,
                         is_traced ? scene.content_revision() : 0,
                         is_traced,
                         is_sampled};
  if (occlusion_key_ == key) {
    return;
  }
  // It stays empty if an exception ends the work, so that the next call does it again.
  const std::optional<OcclusionKey> last = std::exchange(occlusion_key_, std::nullopt);
  bool is_changed = !last || last->world != key.world || last->is_traced != is_traced || last->is_sampled != is_sampled;
  if (!is_traced) {
    occlusion_.reset();
  }
  else {
    auto traced = occlusion_ ? std::move(occlusion_) : std::make_unique<WorldOcclusion>();
    is_changed |= traced->update(scene, is_sampled);
    occlusion_ = std::move(traced);
  }
  if (is_changed) {
    is_block_written_ = false;
    directions_ = {};
    const std::shared_ptr<const render_scene::WorldLight> &world = scene.world();
    if (is_sampled && world && !world->rest_directions.empty()) {
      directions_ = occlusion_ ? occlusion_->directions()
                               : WorldDirections{{world, &world->rest_directions}, WorldDirections::few};
    }
  }
  occlusion_key_ = key;
}

/**
 * For each texel of WorldLight::rest, the sum of world_mirror_weight over \a rest, divided by the number of samples. 1
 * without directions.
 */
static std::vector<float> mirror_weights(const RestDirections &rest)
{
  const glm::ivec2 size = render_scene::WorldLight::size;
  std::vector<float> weights(std::size_t(size.x) * std::size_t(size.y), rest.distribution ? 0.0F : 1.0F);
  const int count = rest.distribution ? rest.sample_count * rest.direction_count : 0;
  std::vector<glm::dvec3> texel_directions;
  for (int i = 0; count > 0 && i < size.x * size.y; i++) {
    texel_directions.push_back(render_scene::direction_of((i % size.x + 0.5) / size.x, (i / size.x + 0.5) / size.y));
  }
  for (int i = 0; i < count; i++) {
    const render_scene::WorldDirection direction = rest.at(std::uint32_t(i));
    const float reach_sq = shared::world_mirror_reach_sq(float(direction.solid_angle / count));
    // The weight ends at twice the reach, which is the chord of this angle.
    const double angle = 2.0 * std::asin(std::sqrt(double(reach_sq)));
    const double elevation = std::asin(std::clamp(direction.to_world.y, -1.0, 1.0));
    const double rows = size.y / std::numbers::pi;
    const int row_first = std::max(int((elevation - angle) * rows + 0.5 * size.y), 0);
    const int row_last = std::min(int((elevation + angle) * rows + 0.5 * size.y), size.y - 1);
    // Widest span of azimuths of a cap that contains no pole.
    const double sine = std::sin(angle) / std::max(std::cos(elevation), 1e-9);
    const bool is_around = std::abs(elevation) + angle >= 0.5 * std::numbers::pi || sine >= 1.0;
    const double columns = size.x / (2.0 * std::numbers::pi);
    const int reach = is_around ? size.x / 2 : std::min(int(std::asin(sine) * columns) + 1, size.x / 2);
    const int middle = int(std::atan2(direction.to_world.z, direction.to_world.x) * columns + 0.5 * size.x);
    for (int y = row_first; y <= row_last; y++) {
      for (int k = middle - reach; k < middle - reach + std::min(2 * reach + 1, size.x); k++) {
        const auto texel = std::size_t(y * size.x + (k + size.x) % size.x);
        const glm::dvec3 apart = texel_directions[texel] - direction.to_world;
        weights[texel] +=
            shared::world_mirror_weight(float(glm::dot(apart, apart)) / reach_sq) / float(rest.sample_count);
      }
    }
  }
  return weights;
}

void SceneWorld::write_level(gpu::Device &device, int level, std::span<const glm::vec3> radiance,
                             std::span<const float> weights) const
{
  std::vector<glm::vec4> texels;
  texels.reserve(radiance.size());
  for (std::size_t i = 0; i < radiance.size(); i++) {
    texels.emplace_back(key_.is_black ? glm::vec3(0.0F) : radiance[i], weights.empty() ? 1.0F : weights[i]);
  }
  device.upload(levels_, level, std::as_bytes(std::span(texels)));
}

void SceneWorld::update_light(const render_scene::RenderScene &scene, Feature features, const Settings &settings,
                              const RestDirections &rest)
{
  const Key key{scene.world_revision(), settings.planned_sample_count(),
                !settings.light.has(LightComponent::Kind::World)};
  if (std::exchange(key_, key) != key || !has(features, Feature::World)) {
    block_ = {};
    levels_ = {};
  }
  if (!has(features, Feature::World)) {
    return;
  }
  if (!block_) {
    block_ = scene.device().create_buffer({"world_block", gpu::BufferKind::Uniform, sizeof(shared::WorldBlock)});
    is_block_written_ = false;
  }
  if (!is_block_written_) {
    write_block(scene);
  }
  if (!has(features, Feature::Specular)) {
    levels_ = {};
  }
  else if (!levels_) {
    make_levels(scene);
    rest_ = {};
  }
  if (levels_ && std::exchange(rest_, rest) != rest) {
    // The first level is not filtered.
    write_level(scene.device(), 0, scene.world()->rest, mirror_weights(rest));
  }
}

void SceneWorld::write_block(const render_scene::RenderScene &scene)
{
  const render_scene::WorldLight &world = *scene.world();
  shared::WorldBlock block{};
  for (std::size_t i = 0; i < world.harmonics.size() && !key_.is_black; i++) {
    block.harmonics[i] = glm::vec4(world.harmonics[i], 0.0F);
  }
  block.sample_count = key_.sample_count > 1 ? key_.sample_count : 0;
  const double lobe_share = world_lobe_directions / (double(std::max(directions_.count, 1)) * key_.sample_count);
  block.alpha_sampled = float(std::sqrt(std::min(lobe_share, 1.0)));
  is_block_written_ = true;
  view_.reset();
  scene.device().update(block_, block);
}

void SceneWorld::follow(const draw::View &view, gpu::Device &device)
{
  if (!block_ || !occlusion_ || key_.sample_count != 1 || view_ == view) {
    return;
  }
  shared::WorldBlock block{};
  occlusion_->write(view, block);
  constexpr std::size_t first = offsetof(shared::WorldBlock, probe_count);
  device.update(block_, first, std::as_bytes(std::span(&block, 1)).subspan(first));
  view_ = view;
}

void SceneWorld::make_levels(const render_scene::RenderScene &scene)
{
  using render_scene::WorldLight;
  gpu::Device &device = scene.device();
  levels_ = device.create_texture({.name = "world_levels",
                                   .kind = gpu::TextureKind::Array,
                                   .format = gpu::Format::RGBA32F,
                                   .width = WorldLight::size.x,
                                   .height = WorldLight::size.y,
                                   .layers = WORLD_LEVEL_COUNT});
  sampler_ =
      device.create_sampler({.name = "world_sampler", .filter = gpu::Filter::Linear, .wrap_u = gpu::Wrap::Repeat});
  const auto levels = render_scene::prefiltered(scene.world()->rest, WORLD_LEVEL_COUNT);
  for (std::size_t i = 0; i < levels.size(); i++) {
    write_level(device, int(i), levels[i], {});
  }
}

void SceneWorld::bind(draw::ShadingGroup &group) const
{
  if (block_) {
    group.bind_uniform("world_block", block_);
  }
  if (levels_) {
    group.bind_texture("world_levels", levels_, sampler_);
  }
}

void SceneWorld::write_suns(std::span<const shared::WorldSunPoint> points, int first_sun, bool is_left_out,
                            gpu::CommandList &list) const
{
  struct {
    int first_sun = 0;
    int sun_count = 0;
    std::array<shared::WorldSunPoint, std::size_t(WORLD_SUN_MAX) * WORLD_SUN_POINTS> points{};
  } values;
  static_assert(sizeof(values) == offsetof(shared::WorldBlock, probe_count) - offsetof(shared::WorldBlock, first_sun));
  if (!block_) {
    return;
  }
  values.first_sun = first_sun;
  values.sun_count = is_left_out ? 0 : int(points.size()) / WORLD_SUN_POINTS;
  std::ranges::copy(points, values.points.begin());
  list.update(block_, offsetof(shared::WorldBlock, first_sun), std::as_bytes(std::span(&values, 1)));
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

void SceneWorld::update_picture(const render_scene::RenderScene &scene, const Settings &settings)
{
  const std::optional<scene::World> &world = scene.scene().world();
  const bool is_shown = settings.background.kind == Background::Kind::World && world && world->picture;
  if (!is_shown || picture_revision_ != scene.scene().world_revision()) {
    picture_ = {};
  }
  if (!is_shown || picture_) {
    return;
  }
  gpu::Device &device = scene.device();
  const auto [size, texels] = texels_of(*world->picture, device.limits().texture_size_max);
  picture_ = device.create_texture(
      {.name = "world_picture", .format = gpu::Format::RGBA32F, .width = size.x, .height = size.y});
  picture_sampler_ = device.create_sampler(
      {.name = "world_picture_sampler", .filter = gpu::Filter::Linear, .wrap_u = gpu::Wrap::Repeat});
  device.upload(picture_, 0, std::as_bytes(std::span(texels)));
  picture_revision_ = scene.scene().world_revision();
}

void SceneWorld::report(ResourceReport &report) const
{
  report.add_target(levels_, "world_levels", "specular reflection of the world",
                    report.why_no_feature(report.has(Feature::World) ? Feature::Specular : Feature::World));
  const int probe_count = occlusion_ && key_.sample_count == 1 ? occlusion_->probe_count() : 0;
  report.add_block(block_, "world_block",
                   probe_count > 0
                       ? fmt::format("light from all around, and its parts that arrive at {} places", probe_count)
                       : "light from all around",
                   report.why_no_feature(Feature::World));
}

}  // namespace gnomon::eevee
