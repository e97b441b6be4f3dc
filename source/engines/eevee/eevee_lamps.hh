// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_features.hh"

#include "eevee_light_shared.h"
#include "scene.hh"

#include <span>

namespace gnomon::eevee {

/** How lamps with a radius, an angle or an area are shaded. */
enum class LampShading {
  /** The whole lamp at once, by formulas. */
  Whole,
  /** One point of it, where LightData has the lamp; the mean over many points is the lamp. */
  Point,
};

/** A lamp's entry of `light_block`, without a shadow: shadow set-up fills that in. */
[[nodiscard]] shared::LightData light_data(const scene::PlacedLamp &lamp);
/** A lamp's entry of `light_shape_block`. */
[[nodiscard]] shared::LightShape light_shape(const scene::PlacedLamp &lamp, LampShading shading);

/** Lamps as the shaders read them. */
struct Lamps {
  shared::LightBlock light_block{};
  /** Read where `features` has LampShape. */
  shared::LightShapeBlock shape_block{};
  /** For each light of the block, the index of its lamp in the list that make_lamps was given. */
  std::vector<std::uint32_t> lamp_index;
  /** Features that the lamps ask for; shadows not among them. */
  Feature features = Feature::None;
  /** One for each lamp that cannot be drawn. */
  std::vector<std::string> warnings;
  /** Lamps past LIGHT_MAX, named. */
  std::vector<std::string> limits;
};

/** Lamps that give no light (black, intensity 0, no area) take no entry. */
[[nodiscard]] Lamps make_lamps(std::span<const scene::PlacedLamp> lamps, LampShading shading = LampShading::Whole);

}  // namespace gnomon::eevee
