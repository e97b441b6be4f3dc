// SPDX-License-Identifier: MIT
#include "eevee_world.hh"

#include "eevee_settings.hh"
#include "eevee_sobol.hh"

#include <numbers>

namespace gnomon::eevee {

render_scene::WorldDirection RestDirections::at(std::uint32_t i) const
{
  return distribution->at(glm::dvec2(sobol_point(i, stream)));
}

std::vector<scene::PlacedLamp> world_lamps(const render_scene::WorldLight &world, int direction_count)
{
  std::vector<scene::PlacedLamp> lamps;
  for (const render_scene::WorldLight::Sun &sun : world.suns) {
    lamps.push_back(sun.lamp);
  }
  for (int i = 0; i < direction_count; i++) {
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

bool has_background(const Settings &settings, const render_scene::RenderScene &scene)
{
  return settings.light.has(LightComponent::Kind::World) &&
         (settings.background.kind == Background::Kind::Color ||
          (settings.background.kind == Background::Kind::World && scene.scene().world()));
}

bool has_world_occlusion(const Settings &settings, const render_scene::RenderScene &scene)
{
  return settings.shadow.kind != scene::ShadowKind::None && settings.light.has(LightComponent::Kind::World) &&
         scene.world() && !scene.world()->rest_directions.empty();
}

}  // namespace gnomon::eevee
