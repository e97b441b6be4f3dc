// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_layer_runs.hh"
#include "shadow_settings.hh"

#include "eevee_lamps.hh"
#include "gpu_device.hh"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gnomon::eevee {

class ShadowTechnique;

/** A light that may cast a shadow, with everything that its shadow depends on. */
struct ShadowLamp {
  /** Identity of the lamp instance: the same in each sync while the lamp exists, different for every lamp. */
  std::uint64_t key = 0;
  /** Index in light_block. */
  int light = 0;
  /** For messages. */
  std::string name{};
  scene::LampKind kind = scene::LampKind::Point;
  glm::mat4 world_from_lamp{1.0F};
  /** Spot: half the opening angle, radians; of an elliptical cone, the widest. */
  float spot_outer_angle = 0.0F;
  /** Metres. 0: no limit. */
  float range = 0.0F;
  scene::LampShadow shadow{};
  /** Each sample of a picture has the shadow of another point of the lamp. */
  bool is_sampled = false;
  /** The same of a sun so wide that no edge of its shadow is sharp: one small map serves all that is seen. */
  bool is_smooth = false;

  [[nodiscard]] glm::vec3 position_ws() const
  {
    return glm::vec3(world_from_lamp[3]);
  }
  /** Distance beyond which nothing casts or receives the lamp's shadow, metres; infinite for suns and without limits.
   */
  [[nodiscard]] float shadow_range() const;
};

/** The lights of \a lamps, in their order. The key is the node's; \a placed is the list that \a lamps was made from. */
[[nodiscard]] std::vector<ShadowLamp> shadow_lamps(std::span<const scene::PlacedLamp> placed, const Lamps &lamps,
                                                   LampShading shading = LampShading::Whole);

/** The kind that the lamp asks for, or else that of \a settings. A sun that asks for Esm or Evsm has Pcf. */
[[nodiscard]] scene::ShadowKind shadow_kind(scene::LampKind lamp, std::optional<scene::ShadowKind> asked,
                                            const ShadowSettings &settings);
[[nodiscard]] scene::ShadowKind shadow_kind(const scene::Lamp &lamp, const ShadowSettings &settings);

/** The arrays of depths. All layers of an array have the size of its largest shadow. */
enum class ShadowArrayId : std::uint8_t {
  Cubes,
  Maps,
  /** The six faces that all octahedral layers are made from, one lamp after the other. */
  DistanceCube,
};
inline constexpr std::size_t shadow_array_count = 3;

/** What a technique needs for one lamp. */
struct ShadowRequest {
  ShadowArrayId array = ShadowArrayId::Cubes;
  /** Most layers that the lamp may have in the array; for each viewport, where the technique follows the view. */
  int layer_count_max = 0;
  /** Entries in the technique's list in the uniform block. */
  int entry_count = 1;
  /** Edge of each layer, texels. */
  int size_px = 0;
  /** Edge of the octahedral layer without its border, texels; 0: there is none. */
  int octahedral_px = 0;
  int octahedral_texel_bytes = 0;
};

/** What a lamp gets. */
struct ShadowPlace {
  /** Index in the planned lamps. */
  std::size_t lamp = 0;
  /** In ShadowPlan::places. */
  std::size_t index = 0;
  const ShadowTechnique *technique = nullptr;
  scene::ShadowKind kind = scene::ShadowKind::Hard;
  /** The request, its sizes lowered to the device's and the memory's limits. */
  ShadowRequest given{};
  /** First entry in the technique's list in the uniform block. The order of the lamps; a new entry redraws nothing. */
  int entry = 0;
  /** In the array. Maps: -1, because their number depends on the view; \see LayerRuns. */
  int first_layer = 0;
};

struct ShadowPlan {
  /** In the order of the lamps. */
  std::vector<ShadowPlace> places;
  /** Layers of the array of cubes. */
  LayerRuns cubes;
  /** Most layers that the array of maps may have, gaps between runs included. */
  int map_layers_max = 0;
  /** Lamps that ask for something without effect. */
  std::vector<std::string> warnings;
  /** Lamps that lost their shadow and sizes that were lowered, with the limit that was hit. */
  std::vector<std::string> limits;
};

/**
 * Decide which of \a lamps have a shadow, its technique, size and place. Needs no device.
 *
 * Priority is the order of \a lamps: where a limit leaves no place for all, the last lamps lose their shadow. Where the
 * shadows need more than ShadowSettings::memory_bytes_max, all sizes are lowered by one factor, to 16 texels at least,
 * because layers of one array have one size; if that does not suffice, the last lamps lose their shadow.
 *
 * Lamps that are sampled have half the size that the settings give, smooth ones a quarter: their errors average out.
 *
 * \a viewport_count: viewports that draw the lamps; each has layers of its own where the technique follows the view.
 * \a previous: the last plan. A lamp that has a place in it keeps it. Only where the gaps that removed lamps leave
 * would exceed the memory or the device's layers, places are given anew.
 *
 * \throws gpu::Error naming the lamp and the setting that is out of range.
 */
[[nodiscard]] ShadowPlan plan_shadows(std::span<const ShadowLamp> lamps, const ShadowSettings &settings,
                                      const gpu::Limits &device_limits, const ShadowPlan &previous,
                                      int viewport_count = 1);

}  // namespace gnomon::eevee
