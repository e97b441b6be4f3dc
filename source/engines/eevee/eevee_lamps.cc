// SPDX-License-Identifier: MIT
#include "eevee_lamps.hh"

#include "eevee_lamp_points.hh"
#include "eevee_shape_shared.h"
#include "shadows/shadow_cube.hh"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace gnomon::eevee {

namespace {

int light_kind(const scene::Lamp &lamp)
{
  switch (lamp.kind) {
    case scene::LampKind::Point: return LIGHT_POINT;
    case scene::LampKind::Sun: return LIGHT_SUN;
    case scene::LampKind::Spot: return LIGHT_SPOT;
    case scene::LampKind::Hemi: return LIGHT_HEMI;
    case scene::LampKind::Area: break;
  }
  return lamp.area_shape == scene::AreaShape::Ellipse ? LIGHT_ELLIPSE : LIGHT_RECTANGLE;
}

bool gives_light(const scene::Lamp &lamp)
{
  const glm::vec3 color = lamp.color * lamp.intensity;
  return color.r > 0.0F || color.g > 0.0F || color.b > 0.0F;
}

}  // namespace

float widest_half_angle(const scene::PlacedLamp &lamp)
{
  const glm::dvec2 scale = lamp.kind == scene::LampKind::Spot ? scene::spot_scale(lamp) : glm::dvec2(1.0);
  const double widest = std::max(scale.x, scale.y);
  const double angle = lamp.spot_outer_angle;
  // atan2, because the tangent of the float nearest to π/2, which is more than π/2, is negative.
  return widest == 1.0 ? lamp.spot_outer_angle : float(std::atan2(widest * std::sin(angle), std::cos(angle)));
}

shared::LightData light_data(const scene::PlacedLamp &lamp)
{
  shared::LightData light{};
  light.kind = light_kind(lamp);
  light.position_ws = glm::vec3(lamp.world_from_lamp[3]);
  // An area lamp with the intensity P and the area A has the radiance P / (4 A), and so the radiant intensity P / 4
  // along its axis.
  light.color = lamp.color * (lamp.kind == scene::LampKind::Area ? 0.25F * lamp.intensity : lamp.intensity);
  light.radius_sq = lamp.kind == scene::LampKind::Sun ? 0.0F : lamp.radius * lamp.radius;
  light.forward_ws = -glm::vec3(lamp.world_from_lamp[2]);
  // The value must be finite for every range, because the shader multiplies it by squared distances that may be 0.
  constexpr float range_sq_min = std::numeric_limits<float>::min();
  light.range_inv_sq = lamp.range > 0.0F ? 1.0F / std::max(lamp.range * lamp.range, range_sq_min) : 0.0F;
  if (lamp.kind == scene::LampKind::Spot) {
    const float sine = std::sin(0.5F * lamp.spot_outer_angle);
    light.spot_drop_outer = 2.0F * sine * sine;
    light.spot_inv_width = shared::spot_inv_width(light.spot_drop_outer, lamp.spot_blend);
  }
  light.shadow_kind = SHADOW_NONE;
  light.shadow_index = -1;
  return light;
}

void leave_out(shared::LightData &light)
{
  // Sampled directions of the world also reflect `world_levels`, which are then black: SceneWorld.
  light.color = glm::vec3(0.0F);
}

shared::LightShape light_shape(const scene::PlacedLamp &lamp, LampShading shading)
{
  shared::LightShape shape{};
  const bool is_whole = shading == LampShading::Whole;
  const glm::dvec3 x_ws(lamp.world_from_lamp[0]);
  const glm::dvec3 y_ws(lamp.world_from_lamp[1]);
  switch (lamp.kind) {
    case scene::LampKind::Point: shape.extent = is_whole ? lamp.radius : 0.0F; break;
    case scene::LampKind::Spot: {
      const glm::dvec2 width = scene::spot_scale(lamp);
      shape.axis_x_ws = glm::vec3(x_ws / width.x);
      shape.axis_y_ws = glm::vec3(y_ws / width.y);
      shape.extent = is_whole ? lamp.radius : 0.0F;
      break;
    }
    case scene::LampKind::Sun: {
      // The limit is just below π/2, whose tangent is infinite.
      constexpr float half_angle_max = 1.57F;
      shape.extent = is_whole ? std::tan(std::min(0.5F * lamp.angle, half_angle_max)) : 0.0F;
      break;
    }
    case scene::LampKind::Area: {
      const glm::dvec2 half_size = scene::area_half_size(lamp);
      shape.axis_x_ws = glm::vec3(half_size.x * x_ws);
      shape.axis_y_ws = glm::vec3(half_size.y * y_ws);
      shape.extent = is_whole ? 1.0F : 0.0F;
      break;
    }
    case scene::LampKind::Hemi: break;
  }
  return shape;
}

/** Features that the shading of \a lamp needs. */
static Feature features_of(const scene::PlacedLamp &lamp, const shared::LightShape &shape)
{
  const bool has_distance =
      lamp.kind == scene::LampKind::Point || lamp.kind == scene::LampKind::Spot || lamp.kind == scene::LampKind::Area;
  const bool is_elliptic = lamp.kind == scene::LampKind::Spot && scene::spot_scale(lamp) != glm::dvec2(1.0);
  const bool has_shape = shape.extent > 0.0F || is_elliptic;
  return Feature::Light | (has_distance ? Feature::Punctual : Feature::None) |
         (has_shape ? Feature::LampShape : Feature::None);
}

std::string listed(std::span<const std::string> names)
{
  constexpr std::size_t named_max = 10;
  const std::size_t named = std::min(names.size(), named_max);
  const std::string more = named < names.size() ? fmt::format(" and {} more", names.size() - named) : "";
  return fmt::format("'{}'{}", fmt::join(names.first(named), "', '"), more);
}

void lower_range(scene::PlacedLamp &lamp, float threshold)
{
  if (threshold <= 0.0F || (lamp.kind != scene::LampKind::Point && lamp.kind != scene::LampKind::Spot)) {
    return;
  }
  const glm::vec3 color = light_data(lamp).color;
  const double intensity = std::max({color.r, color.g, color.b, 0.0F});
  const auto range = float(std::max(std::sqrt(intensity / double(threshold)), 1e-30));
  lamp.range = lamp.range > 0.0F ? std::min(lamp.range, range) : range;
}

LightReach light_reach(const scene::PlacedLamp &lamp, LampShading shading)
{
  const bool has_distance =
      lamp.kind == scene::LampKind::Point || lamp.kind == scene::LampKind::Spot || lamp.kind == scene::LampKind::Area;
  LightReach reach;
  reach.center_ws = glm::vec3(lamp.world_from_lamp[3]);
  if (!has_distance || lamp.range <= 0.0F) {
    return reach;
  }
  double radius = lamp.range;
  if (lamp.kind == scene::LampKind::Spot) {
    // The smallest sphere around a part of a ball that a cone with the half angle cuts out.
    const double angle = widest_half_angle(lamp);
    const double forward =
        angle <= 0.25 * std::numbers::pi ? 0.5 * radius / std::cos(angle) : radius * std::max(std::cos(angle), 0.0);
    radius = angle <= 0.25 * std::numbers::pi ? forward
             : angle < 0.5 * std::numbers::pi ? radius * std::sin(angle)
                                              : radius;
    reach.center_ws -= glm::vec3(forward * glm::dvec3(lamp.world_from_lamp[2]));
  }
  if (shading == LampShading::Point) {
    radius += lamp.kind == scene::LampKind::Area ? glm::length(scene::area_half_size(lamp)) : double(lamp.radius);
  }
  reach.radius = float(radius);
  return reach;
}

Lamps make_lamps(std::span<const scene::PlacedLamp> placed, LampShading shading, std::size_t light_count_max)
{
  Lamps lamps;
  std::vector<std::string> dropped;
  for (std::uint32_t i = 0; i < placed.size(); i++) {
    const scene::PlacedLamp &lamp = placed[i];
    if (!gives_light(lamp)) {
      continue;
    }
    if (lamp.kind == scene::LampKind::Area && scene::area_of(lamp) <= 0.0) {
      lamps.warnings.push_back(fmt::format(
          "lamp '{}': the scale of its node leaves it no area that can be drawn; it gives no light", lamp.name));
      continue;
    }
    if (lamps.lamp_index.size() == light_count_max) {
      dropped.push_back(lamp.name);
      continue;
    }
    lamps.lamp_index.push_back(i);
  }
  std::vector<LightReach> reaches(placed.size());
  /** By index of the lamp: its group, and in it whether it does not reach everywhere. */
  std::vector<int> order(placed.size());
  for (const std::uint32_t index : lamps.lamp_index) {
    const scene::PlacedLamp &lamp = placed[index];
    reaches[index] = light_reach(lamp, shading);
    order[index] = (has_cube(lamp.kind, widest_half_angle(lamp)) ? 0 : 2) + (reaches[index].is_everywhere() ? 0 : 1);
  }
  std::ranges::sort(lamps.lamp_index, {}, [&](std::uint32_t lamp) { return std::pair(order[lamp], lamp); });
  for (const std::uint32_t index : lamps.lamp_index) {
    const scene::PlacedLamp &lamp = placed[index];
    lamps.lights.push_back(light_data(lamp));
    lamps.shapes.push_back(light_shape(lamp, shading));
    lamps.reaches.push_back(reaches[index]);
    lamps.features = lamps.features | features_of(lamp, lamps.shapes.back());
    lamps.cube_light_count += order[index] < 2 ? 1 : 0;
    lamps.cube_everywhere_count += order[index] == 0 ? 1 : 0;
    lamps.other_everywhere_count += order[index] == 2 ? 1 : 0;
  }
  if (!dropped.empty()) {
    lamps.limits.push_back(fmt::format("{} of {} lamps give no light, as at most {} do: {}", dropped.size(),
                                       dropped.size() + light_count_max, light_count_max, listed(dropped)));
  }
  return lamps;
}

void add_surface_points(Lamps &lamps, std::span<const scene::PlacedLamp> placed, std::size_t first)
{
  for (std::size_t i = first; i < placed.size(); i++) {
    lamps.lamp_index.push_back(std::uint32_t(i));
    lamps.lights.push_back(light_data(placed[i]));
    lamps.shapes.push_back(light_shape(placed[i], LampShading::Whole));
    lamps.reaches.push_back(light_reach(placed[i], LampShading::Whole));
    lamps.features = lamps.features | Feature::SurfacePoints;
    lamps.surface_point_count++;
  }
}

void set_highlights(Lamps &lamps, std::span<const scene::PlacedLamp> placed, std::size_t end, int sample_count,
                    const scene::Bounds &receivers_ws)
{
  for (std::size_t i = 0; i < lamps.shapes.size(); i++) {
    const std::size_t index = lamps.lamp_index[i];
    if (index >= end || !has_extent(placed[index])) {
      continue;
    }
    const scene::PlacedLamp &lamp = placed[index];
    shared::LightShape &shape = lamps.shapes[i];
    const bool is_sun = lamp.kind == scene::LampKind::Sun;
    const shared::LightShape whole = light_shape(lamp, LampShading::Whole);
    shape.highlight_points_share = HIGHLIGHT_LOBE_POINTS / float(sample_count);
    shape.center_ws = glm::vec3(lamp.world_from_lamp[is_sun ? 2 : 3]);
    shape.highlight_extent = whole.extent;
    const glm::vec3 to_receivers = glm::clamp(shape.center_ws, receivers_ws.min, receivers_ws.max) - shape.center_ws;
    const float distance_sq = is_sun ? 1.0F : glm::dot(to_receivers, to_receivers);
    const bool is_rectangle = lamps.lights[i].kind == LIGHT_RECTANGLE;
    const float area = shared::flat_lamp_area(whole.axis_x_ws, whole.axis_y_ws, is_rectangle);
    const float solid_angle =
        lamp.kind == scene::LampKind::Area
            ? shared::flat_lamp_solid_angle(area, distance_sq)
            : shared::round_lamp_solid_angle(shared::round_lamp_tangent(whole.extent, distance_sq));
    lamps.highlight_alpha =
        std::max(lamps.highlight_alpha, shared::highlight_alpha(shape.highlight_points_share, solid_angle));
  }
}

void set_kind(Lamps &lamps, std::size_t first, std::size_t end, std::int32_t kind)
{
  for (std::size_t i = 0; i < lamps.lights.size(); i++) {
    if (lamps.lamp_index[i] >= first && lamps.lamp_index[i] < end) {
      lamps.lights[i].kind = kind;
    }
  }
}

}  // namespace gnomon::eevee
