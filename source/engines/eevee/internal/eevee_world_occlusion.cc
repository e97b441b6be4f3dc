// SPDX-License-Identifier: MIT
#include "internal/eevee_world_occlusion.hh"

#include "scene_parallel.hh"

#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>

namespace gnomon::eevee {

namespace {

constexpr int probe_rays = 256;
/** The first rays of a probe, which find bodies around it. */
constexpr int body_rays = 32;

/**
 * Direction of a ray of a probe. Directions are even over the sphere, and mirrored in all axes: a plane that is
 * perpendicular to one blocks exactly a half of the light along the others. Probes have other directions, so that a
 * mean over some probes has more of them.
 */
glm::vec3 ray_direction(std::size_t probe, int ray)
{
  constexpr int octants = 8;
  // The first rays are even over the sphere, too: 9 and 32 have no common factor.
  const int i = 9 * (ray / octants) % (probe_rays / octants);
  const double y = (i + 0.5) * octants / probe_rays;
  const double across = std::sqrt(1.0 - y * y);
  const double turn = i / std::numbers::phi + double(probe) / (std::numbers::phi * std::numbers::phi);
  const double azimuth = 0.5 * std::numbers::pi * (turn - std::floor(turn));
  const glm::vec3 direction(across * std::cos(azimuth), y, across * std::sin(azimuth));
  const glm::ivec3 is_negative(ray & 1, ray >> 1 & 1, ray >> 2 & 1);
  return direction * glm::vec3(1 - 2 * is_negative);
}

double luminance(const glm::dvec3 &radiance)
{
  return glm::dot(radiance, glm::dvec3(0.2126, 0.7152, 0.0722));
}

/** Directions in columns of azimuth and rows of height: cells of the same solid angle. */
constexpr glm::ivec2 grid(32, 16);

bool meets(const scene::Bounds &box, const glm::vec3 &origin, const glm::vec3 &direction)
{
  const glm::vec3 a = (box.min - origin) / direction;
  const glm::vec3 b = (box.max - origin) / direction;
  const glm::vec3 low = glm::min(a, b);
  const glm::vec3 high = glm::max(a, b);
  const float enter = std::max({low.x, low.y, low.z, 0.0F});
  // A ray within a face gives NaN, for which the result is true.
  return !(enter > 1.001F * std::min({high.x, high.y, high.z}));
}

glm::vec3 quotient_or_one(const glm::vec3 &part, const glm::vec3 &whole)
{
  return glm::mix(glm::vec3(1.0F), part / glm::max(whole, glm::vec3(1e-30F)), glm::greaterThan(whole, glm::vec3(0.0F)));
}

}  // namespace

glm::ivec3 WorldOcclusion::place_of(std::size_t probe) const
{
  const int index = int(probe);
  return {index % count_.x, index / count_.x % count_.y, index / (count_.x * count_.y)};
}

void WorldOcclusion::place(const scene::Bounds &bounds_ws)
{
  bounds_ws_ = bounds_ws;
  const glm::vec3 size = glm::max(bounds_ws.max - bounds_ws.min, glm::vec3(1e-6F));
  glm::vec3 extent;
  // Cells that are as cubic as can be. A flat scene has probes at both of its sides.
  float edge = std::max({size.x, size.y, size.z}) / float(WORLD_PROBE_MAX);
  do {
    edge *= 1.02F;
    extent = glm::max(size, glm::vec3(edge));
    count_ = glm::max(glm::ivec3(glm::ceil(extent / edge)), 2);
  } while (probe_count() > WORLD_PROBE_MAX);
  step_ = extent / glm::vec3(count_);
  first_ws_ = 0.5F * (bounds_ws.min + bounds_ws.max - extent + step_);
}

void WorldOcclusion::trace(std::span<const scene::Bounds> changed)
{
  // A ray is tested against each of a few bounds, or against those of all.
  constexpr std::size_t bounds_max = 16;
  scene::Bounds all;
  if (changed.size() > bounds_max) {
    for (const scene::Bounds &box : changed) {
      all.extend(box);
    }
    changed = std::span(&all, 1);
  }
  std::atomic<std::uint64_t> traced = 0;
  scene::parallel_for(std::size_t(probe_count()), 0, [&](std::size_t probe) {
    const glm::vec3 position_ws = first_ws_ + glm::vec3(place_of(probe)) * step_;
    std::uint64_t count = 0;
    for (int ray = 0; ray < probe_rays; ray++) {
      const glm::vec3 direction = ray_direction(probe, ray);
      if (std::ranges::any_of(changed, [&](const scene::Bounds &box) { return meets(box, position_ws, direction); })) {
        hits_[probe * probe_rays + std::size_t(ray)] = casters_.trace(position_ws, direction, ray < body_rays);
        count++;
      }
    }
    traced += count;
  });
  rays_traced_ += traced;
}

void WorldOcclusion::light_rays()
{
  constexpr glm::ivec2 size = render_scene::WorldLight::size;
  rays_.resize(hits_.size());
  scene::parallel_for(std::size_t(probe_count()), 0, [&](std::size_t probe) {
    for (int ray = 0; ray < probe_rays; ray++) {
      const glm::vec3 direction = ray_direction(probe, ray);
      const glm::vec2 place = shared::equirectangular(direction);
      const glm::ivec2 texel = glm::clamp(glm::ivec2(place * glm::vec2(size)), glm::ivec2(0), size - 1);
      const glm::vec2 even(place.x, 0.5F + 0.5F * direction.y);
      const glm::ivec2 cell = glm::min(glm::ivec2(even * glm::vec2(grid)), grid - 1);
      rays_[probe * probe_rays + std::size_t(ray)] = {
          std::uint16_t(cell.y * grid.x + cell.x),
          float(luminance(world_->rest[std::size_t(texel.y * size.x + texel.x)]))};
    }
  });
}

void WorldOcclusion::add_up()
{
  probes_.assign(std::size_t(probe_count()), {});
  struct Whole {
    glm::vec3 positive{0.0F};
    glm::vec3 negative{0.0F};
  };
  std::vector<Whole> wholes(probes_.size());
  scene::parallel_for(probes_.size(), 0, [&](std::size_t probe) {
    const auto hits = std::span(hits_).subspan(probe * probe_rays, probe_rays);
    const auto backs = std::ranges::count(hits.first(body_rays), RayHit::Back);
    const auto fronts = std::ranges::count(hits.first(body_rays), RayHit::Front);
    // Below a ground of one side, half of the rays meet its back.
    const bool is_inside = 4 * backs >= body_rays && backs >= 4 * fronts;
    probes_[probe].weight = is_inside ? 1e-2F : 1.0F;
    glm::vec3 positive(0.0F);
    glm::vec3 negative(0.0F);
    Whole &whole = wholes[probe];
    for (int ray = 0; ray < probe_rays; ray++) {
      const glm::vec3 direction = ray_direction(probe, ray);
      const float light = rays_[probe * probe_rays + std::size_t(ray)].luminance;
      const float part = hits[std::size_t(ray)] == RayHit::None ? light : 0.0F;
      const glm::vec3 along = glm::max(direction, glm::vec3(0.0F));
      const glm::vec3 against = glm::max(-direction, glm::vec3(0.0F));
      whole.positive += light * along;
      whole.negative += light * against;
      positive += part * along;
      negative += part * against;
    }
    // Quotients of sums over the same rays: where nothing blocks any, they are exactly 1.
    probes_[probe].positive = quotient_or_one(positive, whole.positive);
    probes_[probe].negative = quotient_or_one(negative, whole.negative);
  });
  whole_positive_ = whole_negative_ = glm::vec3(0.0F);
  for (const Whole &whole : wholes) {
    whole_positive_ += whole.positive;
    whole_negative_ += whole.negative;
  }
}

WorldDirections WorldOcclusion::directions() const
{
  struct Cell {
    double arriving = 0.0;
    double whole = 0.0;
  };
  std::array<Cell, std::size_t(grid.x * grid.y)> cells;
  Cell all;
  for (std::size_t probe = 0; probe < std::size_t(probe_count()); probe++) {
    const auto hits = std::span(hits_).subspan(probe * probe_rays, probe_rays);
    // A probe counts by the surfaces that face it: none do inside of a body, below a ground or high above it.
    const auto seen = double(std::ranges::count(hits.first(body_rays), RayHit::Front));
    for (int ray = 0; ray < probe_rays; ray++) {
      const Ray &lit = rays_[probe * probe_rays + std::size_t(ray)];
      Cell &sum = cells[lit.cell];
      sum.whole += seen;
      sum.arriving += hits[std::size_t(ray)] == RayHit::None ? seen : 0.0;
      const double light = seen * double(lit.luminance);
      all.whole += light;
      all.arriving += hits[std::size_t(ray)] == RayHit::None ? light : 0.0;
    }
  }
  WorldDirections result{{world_, &world_->rest_directions}, WorldDirections::few};
  if (!(all.arriving > 0.0)) {
    return result;
  }
  // A place gets all light of a direction or none. The least variance has the root of the mean of its square.
  const auto brought = [&](double column, double row) {
    const glm::dvec2 low = glm::floor(glm::dvec2(column, row));
    double value = 0.0;
    for (int corner = 0; corner < 4; corner++) {
      const glm::dvec2 near = low + glm::dvec2(corner & 1, corner >> 1);
      const glm::dvec2 share = 1.0 - glm::abs(glm::dvec2(column, row) - near);
      const int x = (int(near.x) + grid.x) % grid.x;
      const int y = std::clamp(int(near.y), 0, grid.y - 1);
      const Cell &cell = cells[std::size_t(y * grid.x + x)];
      value += share.x * share.y * cell.arriving / std::max(cell.whole, 1.0);
    }
    return std::sqrt(value);
  };
  constexpr glm::ivec2 size = render_scene::WorldLight::size;
  std::vector<float> importance;
  importance.reserve(world_->rest.size());
  double sum = 0.0;
  double whole = 0.0;
  for (int y = 0; y < size.y; y++) {
    const double height = 0.5 + 0.5 * render_scene::direction_of(0.0, (y + 0.5) / size.y).y;
    const double solid_angle = render_scene::texel_solid_angle(y, size.x, size.y);
    for (int x = 0; x < size.x; x++) {
      const double value = brought(grid.x * (x + 0.5) / size.x - 0.5, grid.y * height - 0.5);
      const double light = solid_angle * luminance(world_->rest[importance.size()]);
      importance.push_back(float(value));
      sum += light * value;
      whole += light;
    }
  }
  // For directions from which light arrives only where no probe is.
  constexpr double least = 0.15;
  for (float &value : importance) {
    value = float(least + (1.0 - least) * double(value) * whole / sum);
  }
  result.distribution = std::make_shared<const render_scene::WorldDistribution>(
      render_scene::rest_distribution(world_->rest, importance));
  // In an open place half of the directions are below the ground. In a room, most meet a wall.
  if (all.arriving < 0.125 * all.whole) {
    result.count = WorldDirections::many;
  }
  return result;
}

bool WorldOcclusion::update(const render_scene::RenderScene &scene, bool has_probes)
{
  const std::vector<scene::Bounds> changed = casters_.update(scene);
  const scene::Bounds bounds_ws = scene.bounds();
  if (casters_.empty()) {
    const bool has_blocked = probe_count() > 0;
    count_ = glm::ivec3(0);
    world_ = scene.world();
    return has_blocked;
  }
  bool is_changed = !changed.empty();
  if (probe_count() == 0 || bounds_ws.min != bounds_ws_.min || bounds_ws.max != bounds_ws_.max) {
    place(bounds_ws);
    hits_.assign(std::size_t(probe_count()) * probe_rays, RayHit::None);
    trace(std::span(&bounds_ws, 1));
    is_changed = true;
  }
  else if (is_changed) {
    trace(changed);
  }
  if (world_ != scene.world() || rays_.size() != hits_.size()) {
    world_ = scene.world();
    light_rays();
    is_changed = true;
  }
  if (is_changed) {
    probes_.clear();
  }
  if (has_probes && probes_.empty()) {
    add_up();
  }
  return is_changed;
}

void WorldOcclusion::write(shared::WorldBlock &block) const
{
  if (probe_count() == 0) {
    return;
  }
  block.probe_count = glm::vec4(count_, 0.0F);
  block.probe_scale = glm::vec4(1.0F / step_, 0.0F);
  block.probe_offset = glm::vec4(-first_ws_ / step_, 0.0F);
  block.whole_positive = glm::vec4(whole_positive_, 0.0F);
  block.whole_negative = glm::vec4(whole_negative_, 0.0F);
  for (std::size_t i = 0; i < std::size_t(probe_count()); i++) {
    block.probes[2 * i] = glm::vec4(glm::sqrt(probes_[i].positive), probes_[i].weight);
    block.probes[2 * i + 1] = glm::vec4(glm::sqrt(probes_[i].negative), 0.0F);
  }
}

}  // namespace gnomon::eevee
