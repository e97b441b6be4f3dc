// SPDX-License-Identifier: MIT
#include "eevee_lamp_points.hh"

#include "eevee_sequence_shared.h"
#include "eevee_sobol.hh"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace gnomon::eevee {

namespace {

constexpr double pi = std::numbers::pi;

/** Most radiant intensity of a point of an emissive surface, W/sr, so that products with it stay finite. */
constexpr double light_color_max = 1e30;

/** Half the angular diameter of a sun, radians, at most π/2. */
double half_angle(const scene::Lamp &lamp)
{
  return std::min(0.5 * double(lamp.angle), 0.5 * pi);
}

/** An orthonormal basis whose third vector is the unit vector \a z. */
glm::dmat3 axes_around(const glm::dvec3 &z)
{
  const glm::dvec3 helper = std::abs(z.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0);
  const glm::dvec3 x = glm::normalize(glm::cross(helper, z));
  return {x, glm::cross(z, x), z};
}

/** A point in the unit ball with a density ∝ (1 - ρ²)^(-1/2): uniform on the disk in xy, arcsine-distributed in z. */
glm::dvec3 in_ball(const glm::vec3 &place)
{
  const glm::dvec2 disk = on_disk(glm::dvec2(place));
  const double half_chord = std::sqrt(std::max(1.0 - glm::dot(disk, disk), 0.0));
  return {disk, half_chord * std::sin(pi * (double(place.z) - 0.5))};
}

/** \a world_from_lamp rotated so that the lamp shines along the unit vector \a forward_ws. */
glm::dmat4 turned(const glm::dmat4 &world_from_lamp, const glm::dvec3 &forward_ws)
{
  const glm::dvec3 z = -forward_ws;
  glm::dvec3 x(world_from_lamp[0]);
  glm::dvec3 y(world_from_lamp[1]);
  // The axis that is more perpendicular to the new direction keeps its direction as far as possible.
  if (std::abs(glm::dot(x, z)) < std::abs(glm::dot(y, z))) {
    x = glm::normalize(x - z * glm::dot(x, z));
    y = glm::cross(z, x);
  }
  else {
    y = glm::normalize(y - z * glm::dot(y, z));
    x = glm::cross(y, z);
  }
  return {glm::dvec4(x, 0.0), glm::dvec4(y, 0.0), glm::dvec4(z, 0.0), world_from_lamp[3]};
}

}  // namespace

bool has_extent(const scene::Lamp &lamp)
{
  switch (lamp.kind) {
    case scene::LampKind::Point:
    case scene::LampKind::Spot: return lamp.radius > 0.0F;
    case scene::LampKind::Sun: return lamp.angle > 0.0F;
    case scene::LampKind::Area: return true;
    default: return false;
  }
}

glm::mat4 point_of(const scene::PlacedLamp &lamp, const glm::vec3 &place, const glm::vec3 &toward_ws)
{
  if (lamp.kind == scene::LampKind::Sun) {
    const glm::dvec2 disk = on_disk(glm::dvec2(place));
    const double radius_sq = glm::dot(disk, disk);
    const double sine = std::sin(0.5 * half_angle(lamp));
    const double drop = 2.0 * sine * sine * radius_sq;
    const double across = radius_sq > 0.0 ? std::sqrt(drop * (2.0 - drop) / radius_sq) : 0.0;
    const glm::dmat3 axes(lamp.world_from_lamp);
    const glm::dvec3 forward = axes * glm::dvec3(across * disk, drop - 1.0);
    return turned(lamp.world_from_lamp, glm::normalize(forward));
  }
  const glm::dvec3 center(lamp.world_from_lamp[3]);
  glm::dmat4 moved = lamp.world_from_lamp;
  if (lamp.kind == scene::LampKind::Area) {
    const glm::dvec2 across =
        lamp.area_shape == scene::AreaShape::Ellipse ? on_disk(glm::dvec2(place)) : 2.0 * glm::dvec2(place) - 1.0;
    moved[3] = moved * glm::dvec4(scene::area_half_size(lamp) * across, 0.0, 1.0);
    return moved;
  }
  const glm::dvec3 toward = glm::dvec3(toward_ws) - center;
  const double distance = glm::length(toward);
  const glm::dmat3 axes = axes_around(distance > 0.0 ? toward / distance : glm::dvec3(0, 0, -1));
  moved[3] = glm::dvec4(center + axes * (double(lamp.radius) * in_ball(place)), 1.0);
  return moved;
}

LampPoints::LampPoints(std::span<const scene::PlacedLamp> placed, const Lamps &lamps, const glm::vec3 &toward_ws,
                       std::shared_ptr<const render_scene::WorldLight> world, const WorldDirections &directions,
                       int sample_count, std::shared_ptr<const scene::EmissiveSurfaces> emission, int emission_count)
    : world_(std::move(world)),
      directions_(directions),
      emission_(std::move(emission)),
      sample_count_(sample_count),
      toward_ws_(toward_ws)
{
  const std::size_t world_first = placed.size() - (world_ ? world_->suns.size() + std::size_t(directions_.count) : 0);
  const std::size_t emission_first = world_first - (emission_ ? std::size_t(emission_count) : 0);
  for (int i = 0; i < lamps.light_count(); i++) {
    const std::size_t index = lamps.lamp_index[std::size_t(i)];
    const scene::PlacedLamp &lamp = placed[index];
    if (!has_extent(lamp)) {
      continue;
    }
    const shared::LightData &light = lamps.lights[std::size_t(i)];
    Sized &sized = sized_.emplace_back(Sized{i, std::uint32_t(index), lamp, light.color, light.radius_sq});
    if (index >= world_first) {
      const std::size_t part = index - world_first;
      const std::size_t sun_count = world_->suns.size();
      sized.world = part < sun_count ? &world_->suns[part].directions : directions_.distribution.get();
      sized.direction = part < sun_count ? 0 : std::uint32_t(part - sun_count);
      sized.direction_count = part < sun_count ? 1 : std::uint32_t(directions_.count);
    }
    else if (index >= emission_first) {
      sized.is_emission = true;
      sized.direction = std::uint32_t(index - emission_first);
      sized.direction_count = std::uint32_t(emission_count);
    }
  }
}

std::uint32_t lamp_stream(std::uint32_t seed, std::size_t lamp)
{
  return shared::mixed_bits(seed) + std::uint32_t(lamp);
}

std::uint32_t LampPoints::stream_of(const Sized &sized, std::uint32_t seed)
{
  return lamp_stream(seed, sized.index - sized.direction);
}

LampPoint LampPoints::world_point(const Sized &sized, std::uint32_t index, std::uint32_t seed) const
{
  const std::uint32_t stream = stream_of(sized, seed);
  const glm::vec3 place = sobol_point(index * sized.direction_count + sized.direction, stream);
  const render_scene::WorldDirection direction = sized.world->at(glm::dvec2(place));
  const double count = sized.direction_count;
  LampPoint point{.light = sized.light,
                  .world_from_lamp = turned(sized.lamp.world_from_lamp, -direction.to_world),
                  .color = glm::vec3(direction.irradiance / count)};
  // A lobe with the roughness alpha has a solid angle of about 4 π alpha².
  const double alpha_sq = WORLD_SUN_LOBE_DIRECTIONS * sized.world->solid_angle() / (4.0 * pi * sample_count_);
  point.radius_sq = float(sized.direction_count > 1 ? direction.solid_angle / count : alpha_sq);
  return point;
}

RestDirections LampPoints::rest_directions(std::uint32_t seed) const
{
  for (const Sized &sized : sized_) {
    if (sized.world && sized.world == directions_.distribution.get()) {
      return {directions_.distribution, sample_count_, directions_.count, stream_of(sized, seed)};
    }
  }
  return {};
}

LampPoint emissive_point(const scene::EmissiveSurfaces &surfaces, std::uint32_t index, std::uint32_t stream, int count,
                         int sample_count)
{
  const scene::EmissivePoint chosen = surfaces.at(glm::dvec3(sobol_point(index, stream)));
  const double area = chosen.area / double(count);
  const glm::dmat3 axes = axes_around(-chosen.normal);
  const glm::dmat4 world_from_lamp(glm::dvec4(axes[0], 0.0), glm::dvec4(axes[1], 0.0), glm::dvec4(axes[2], 0.0),
                                   glm::dvec4(chosen.position, 1.0));
  LampPoint point{.world_from_lamp = glm::mat4(world_from_lamp),
                  .color = glm::vec3(glm::min(chosen.radiance * area, glm::dvec3(light_color_max)))};
  // All points of the picture together cover the surfaces by disks.
  point.radius_sq = float(area / (pi * sample_count));
  return point;
}

void LampPoints::add_sun_points(const Sized &sized, std::uint32_t index, std::uint32_t seed, SampledLampPoints &sampled)
{
  if (sampled.sun_points.empty()) {
    sampled.first_sun = sized.light;
  }
  // The complement is a stream of no lamp.
  const std::uint32_t stream = lamp_stream(seed, ~sized.index);
  for (std::uint32_t i = 0; i < WORLD_SUN_POINTS; i++) {
    const render_scene::WorldDirection direction =
        sized.world->at(glm::dvec2(sobol_point(index * WORLD_SUN_POINTS + i, stream)));
    shared::WorldSunPoint &point = sampled.sun_points.emplace_back();
    point.to_world = glm::vec3(direction.to_world);
    point.irradiance = glm::vec3(direction.irradiance / double(WORLD_SUN_POINTS));
  }
}

SampledLampPoints LampPoints::sample(std::uint32_t index, std::uint32_t seed, SampledLampPoints memory) const
{
  SampledLampPoints sampled = std::move(memory);
  sampled.points.clear();
  sampled.sun_points.clear();
  sampled.points.reserve(sized_.size());
  for (const Sized &sized : sized_) {
    if (sized.is_emission) {
      sampled.points.push_back(emissive_point(*emission_, index * sized.direction_count + sized.direction,
                                              stream_of(sized, seed), int(sized.direction_count), sample_count_));
      sampled.points.back().light = sized.light;
      continue;
    }
    if (sized.world) {
      sampled.points.push_back(world_point(sized, index, seed));
      if (sized.world != directions_.distribution.get()) {
        add_sun_points(sized, index, seed, sampled);
      }
      continue;
    }
    const glm::vec3 place = sobol_point(index, stream_of(sized, seed));
    // The mean of the unit vectors in a cone of half angle a has the length (1 + cos a) / 2.
    const double weight =
        sized.lamp.kind == scene::LampKind::Sun ? 2.0 / (1.0 + std::cos(half_angle(sized.lamp))) : 1.0;
    const glm::mat4 world_from_lamp = point_of(sized.lamp, place, toward_ws_);
    const glm::vec3 center_ws(sized.lamp.world_from_lamp[3]);
    sampled.points.push_back({sized.light, world_from_lamp, glm::distance(glm::vec3(world_from_lamp[3]), center_ws),
                              float(weight) * sized.color, sized.radius_sq});
  }
  return sampled;
}

SampledLampPoints LampPoints::centers() const
{
  SampledLampPoints sampled;
  for (const Sized &sized : sized_) {
    sampled.points.push_back({sized.light, glm::mat4(sized.lamp.world_from_lamp), 0.0F, sized.color, sized.radius_sq});
  }
  return sampled;
}

shared::LightData light_at(shared::LightData light, const LampPoint &point)
{
  light.position_ws = glm::vec3(point.world_from_lamp[3]);
  light.forward_ws = -glm::vec3(point.world_from_lamp[2]);
  light.color = point.color;
  light.radius_sq = point.radius_sq;
  return light;
}

}  // namespace gnomon::eevee
