// SPDX-License-Identifier: MIT
#include "eevee_lamps.hh"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace gnomon::eevee {

namespace {

int light_kind(scene::LampKind kind)
{
  switch (kind) {
    case scene::LampKind::Point: return LIGHT_POINT;
    case scene::LampKind::Sun: return LIGHT_SUN;
    case scene::LampKind::Spot: return LIGHT_SPOT;
    case scene::LampKind::Hemi: return LIGHT_HEMI;
    case scene::LampKind::Area: break;
  }
  return -1;
}

bool gives_light(const scene::Lamp &lamp)
{
  const glm::vec3 color = lamp.color * lamp.intensity;
  return color.r > 0.0F || color.g > 0.0F || color.b > 0.0F;
}

void warn_of_size(const scene::Lamp &lamp, std::vector<std::string> &warnings)
{
  if (lamp.radius > 0.0F) {
    warnings.push_back(fmt::format("lamp '{}': penumbrae are not drawn yet; its radius of {:g} m softens no shadow",
                                   lamp.name, lamp.radius));
  }
  if (lamp.angle > 0.0F) {
    warnings.push_back(fmt::format("lamp '{}': penumbrae are not drawn yet; its angle of {:g} rad softens no shadow",
                                   lamp.name, lamp.angle));
  }
}

}  // namespace

shared::LightData light_data(const scene::PlacedLamp &lamp)
{
  shared::LightData light{};
  light.kind = light_kind(lamp.kind);
  light.position_ws = glm::vec3(lamp.world_from_lamp[3]);
  light.color = lamp.color * lamp.intensity;
  light.radius_sq = lamp.radius * lamp.radius;
  light.forward_ws = -glm::vec3(lamp.world_from_lamp[2]);
  // Finite for every range: times a distance of 0 it must be 0.
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

Lamps make_lamps(std::span<const scene::PlacedLamp> placed)
{
  Lamps lamps;
  std::vector<std::string> dropped;
  for (std::uint32_t i = 0; i < placed.size(); i++) {
    const scene::PlacedLamp &lamp = placed[i];
    if (!gives_light(lamp)) {
      continue;
    }
    if (lamp.kind == scene::LampKind::Area) {
      lamps.warnings.push_back(fmt::format("lamp '{}': area lamps are not drawn yet", lamp.name));
      continue;
    }
    if (lamps.light_block.light_count == LIGHT_MAX) {
      dropped.push_back(lamp.name);
      continue;
    }
    warn_of_size(lamp, lamps.warnings);
    lamps.light_block.lights[lamps.light_block.light_count++] = light_data(lamp);
    lamps.lamp_index.push_back(i);
    lamps.features = lamps.features | Feature::Light;
    if (lamp.kind == scene::LampKind::Point || lamp.kind == scene::LampKind::Spot) {
      lamps.features = lamps.features | Feature::Punctual;
    }
  }
  if (!dropped.empty()) {
    lamps.limits.push_back(fmt::format("{} of {} lamps give no light, as light_block holds {}: '{}'", dropped.size(),
                                       dropped.size() + LIGHT_MAX, LIGHT_MAX, fmt::join(dropped, "', '")));
  }
  return lamps;
}

}  // namespace gnomon::eevee
