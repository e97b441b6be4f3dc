// SPDX-License-Identifier: MIT
#include "internal/gltf_lamp_units.hh"

#include "internal/gltf_units.hh"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <variant>
#include <vector>

namespace gnomon::gltf {

using scene::Bounds;
using scene::Handle;
using scene::Lamp;
using scene::LampKind;
using scene::Scene;

namespace {

/**
 * Radiance of a white surface, W/(sr m²), below which a picture without exposure is dark. Blender's lamp of 1 kW,
 * exported unitless, gives 0.037 at a distance of 1 m, and a bulb of 800 lm in right units 0.03.
 */
constexpr double dim_radiance = 0.05;
/** Below which it is nearly black. */
constexpr double black_radiance = 0.01;
/** Products of lamps and objects beyond which no file is said to look raw, because the search would take too long. */
constexpr std::size_t pair_count_max = std::size_t(1) << 26U;

/** Distance to the nearest side of the box, from inside and from outside. */
double distance_to(const Bounds &box, const glm::dvec3 &point)
{
  const glm::dvec3 half = 0.5 * glm::dvec3(box.max - box.min);
  const glm::dvec3 beyond = glm::abs(point - glm::dvec3(box.center())) - half;
  const glm::dvec3 outside = glm::max(beyond, 0.0);
  const double inside = -std::max({beyond.x, beyond.y, beyond.z});
  return inside > 0.0 ? inside : glm::length(outside);
}

/**
 * Radiance that the brightest lamp gives a white surface that faces it at the nearest object; infinite if the file has
 * other lights, or nothing that lamps light.
 */
double brightest_radiance(const Scene &scene, std::size_t punctual_count)
{
  constexpr double infinite = std::numeric_limits<double>::infinity();
  const std::vector<scene::PlacedLamp> lamps = scene.placed_lamps();
  std::vector<Bounds> boxes;
  for (const scene::Object &object : scene.objects()) {
    boxes.push_back(transformed(scene.meshes()[object.mesh].bounds, glm::mat4(object.world_from_object)));
  }
  if (scene.world() || lamps.size() != punctual_count || boxes.empty() ||
      lamps.size() * boxes.size() > pair_count_max) {
    return infinite;
  }
  // A lamp may be in the middle of a small object, such as its shade, which is not all that it is meant to light.
  const double nearest_min = std::min(1.0, 0.1 * double(scene.bounds().radius()));
  double brightest = 0.0;
  for (const scene::PlacedLamp &lamp : lamps) {
    double irradiance = double(lamp.intensity) * double(std::max({lamp.color.r, lamp.color.g, lamp.color.b}));
    if (lamp.kind != LampKind::Sun && lamp.kind != LampKind::Hemi) {
      double distance = infinite;
      for (const Bounds &box : boxes) {
        distance = std::min(distance, distance_to(box, glm::dvec3(lamp.world_from_lamp[3])));
      }
      distance = std::max(distance, nearest_min);
      irradiance /= distance * distance;
    }
    brightest = std::max(brightest, irradiance / std::numbers::pi);
  }
  return brightest;
}

}  // namespace

void convert_lamps(LampUnits units, const ImportedThings &things, Warnings &warnings, Scene &scene)
{
  std::vector<Handle<Lamp>> punctual;
  for (const auto &[light, lamps] : things.lamps) {
    // Lamps without a light have units of their own.
    if (light >= 0) {
      punctual.insert(punctual.end(), lamps.begin(), lamps.end());
    }
  }
  if (punctual.empty()) {
    return;
  }
  if (units != LampUnits::Raw) {
    const double radiance = brightest_radiance(scene, punctual.size());
    if (!(radiance > 0.0) || radiance >= dim_radiance) {
      return;
    }
    const bool is_raw = units == LampUnits::Auto && radiance < black_radiance;
    warnings.add(
        "lamps",
        "the brightest gives a white surface a radiance of " + text(float(radiance)) + ", where 1 is white: the file " +
            (radiance < black_radiance ? "was probably" : "may have been") + " exported unitless; " +
            (is_raw ? "its numbers are read as W/sr and W/m2" : "--lamp-units raw reads its numbers as W/sr and W/m2"));
    if (!is_raw) {
      return;
    }
  }
  const scene::Description intensity = scene::description_of<Lamp>("intensity");
  for (const Handle<Lamp> handle : punctual) {
    scene.edit(handle,
               [&](Lamp &lamp) { lamp.intensity = intensity.nearest(double(lamp.intensity) * lumen_per_watt); });
  }
  for (scene::Animation &animation : scene.animations) {
    for (scene::AnimatedValue &value : animation.values) {
      if (value.property == "intensity" && std::holds_alternative<Handle<Lamp>>(value.target)) {
        value.factor *= lumen_per_watt;
      }
    }
  }
}

}  // namespace gnomon::gltf
