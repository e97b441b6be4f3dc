// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_features.hh"

#include "eevee_light_shared.h"
#include "scene.hh"

#include <span>

namespace gnomon::eevee {

/** How lamps with a radius, an angle or an area are shaded. */
enum class LampShading {
  /** Closed-form shading of the whole lamp. */
  Whole,
  /** Shading of one point of the lamp, at the position in LightData. The mean over many points gives the whole lamp. */
  Point,
};

/** The entry of a lamp in `light_block`, without its shadow. SceneShadows::sync writes the members of the shadow. */
[[nodiscard]] shared::LightData light_data(const scene::PlacedLamp &lamp);
/** The entry of a lamp in `light_shape_block`. */
[[nodiscard]] shared::LightShape light_shape(const scene::PlacedLamp &lamp, LampShading shading);

/** Let \a light give no light. Its shadow and its points stay as they are. */
void leave_out(shared::LightData &light);

/** The data of all lamps that give light, in the layout of the shaders. */
struct Lamps {
  shared::LightBlock light_block{};
  /** Read by the shaders only with Feature::LampShape. */
  shared::LightShapeBlock shape_block{};
  /** For each light of the block, the index of its lamp in the argument of make_lamps. */
  std::vector<std::uint32_t> lamp_index;
  /** Features that the lamps need, without those of shadows. */
  Feature features = Feature::None;
  /** One message for each lamp that cannot be drawn. */
  std::vector<std::string> warnings;
  /** A message with the names of the lamps that exceed LIGHT_MAX. */
  std::vector<std::string> limits;
};

/**
 * The data of \a lamps. Lamps with has_cube are first; both groups keep the order of \a lamps. Lamps that give no light
 * (black, intensity 0, no area) get no entry.
 */
[[nodiscard]] Lamps make_lamps(std::span<const scene::PlacedLamp> lamps, LampShading shading = LampShading::Whole);

}  // namespace gnomon::eevee
