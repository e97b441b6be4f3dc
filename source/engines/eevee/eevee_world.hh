// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_lamps.hh"

#include "render_scene.hh"
#include "render_world.hh"

#include <memory>
#include <vector>

/** Light of the scene's world, and the background of a picture. \see render_world.hh */
namespace gnomon::eevee {

struct Settings;

/** The directions of WorldLight::rest that each sample draws in a picture of several samples. */
struct WorldDirections {
  /** Null: there are none. */
  std::shared_ptr<const render_scene::WorldDistribution> distribution{};
  int count = 0;

  /** `count` where much of the light arrives, and where little does, so that few of all directions light a point. */
  static constexpr int few = 4;
  static constexpr int many = 8;
};

/** The directions of the rest of a world over all samples of a picture. */
struct RestDirections {
  /** Null: there are none. */
  std::shared_ptr<const render_scene::WorldDistribution> distribution{};
  /** Number of samples, and of directions of each. */
  int sample_count = 0;
  int direction_count = 0;
  std::uint32_t stream = 0;

  [[nodiscard]] render_scene::WorldDirection at(std::uint32_t i) const;
  bool operator==(const RestDirections &) const = default;
};

/** A specular lobe is lit by sampled directions if it contains at least this number of them over all samples. */
inline constexpr double world_lobe_directions = 12.0;

/**
 * Lamps without a node that light a scene with \a world: its suns, and \a direction_count lamps for WorldLight::rest,
 * to which LampPoints gives a new direction in each sample.
 */
[[nodiscard]] std::vector<scene::PlacedLamp> world_lamps(const render_scene::WorldLight &world, int direction_count);

/** Whether pixels without a surface show a background. */
[[nodiscard]] bool has_background(const Settings &settings, const render_scene::RenderScene &scene);
/** Whether the occlusion of the world's light is traced, at probes. */
[[nodiscard]] bool has_world_occlusion(const Settings &settings, const render_scene::RenderScene &scene);

}  // namespace gnomon::eevee
