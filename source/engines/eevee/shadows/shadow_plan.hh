// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_layer_runs.hh"

#include "eevee_lamps.hh"
#include "eevee_shadow_settings.hh"
#include "gpu_device.hh"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gnomon::eevee {

class ShadowTechnique;

/** A lamp that may cast a shadow, with everything that its shadow depends on. */
struct ShadowLamp {
  /** Identity of the lamp instance: unique, and the same in each sync while the lamp exists. */
  std::uint64_t key = 0;
  /** Index in Lamps::lights. */
  int light = 0;
  /** Name for messages. */
  std::string name{};
  scene::LampKind kind = scene::LampKind::Point;
  glm::mat4 world_from_lamp{1.0F};
  /** Spots: half the opening angle, radians. For an elliptical cone, half the largest opening angle. */
  float spot_outer_angle = 0.0F;
  /** Range of the lamp, metres. 0: no limit. */
  float range = 0.0F;
  scene::LampShadow shadow{};
  /**
   * Above 0: the lamp is shaded as a whole, so that its lookups reach beyond visible receivers. Half of its longest
   * edge or axis, metres; for a sun, the tangent of half its angle.
   */
  float extent = 0.0F;
  /** The lamp has an extent, and each sample of a picture has the shadow of another point of the lamp. */
  bool is_sampled = false;
  /** A sampled sun whose angle is so large that its shadow has no sharp edges. One map of lower resolution suffices. */
  bool is_smooth = false;

  [[nodiscard]] glm::vec3 position_ws() const
  {
    return glm::vec3(world_from_lamp[3]);
  }
  /** Maximum distance of casters and receivers, metres. Infinite for suns, and for lamps without range and clip_end. */
  [[nodiscard]] float shadow_range() const;
};

/**
 * The lamps of all lights, in the order of \a placed, which is their priority. \a placed: the list from which \a lamps
 * was made. The key of a lamp is the key of its node.
 */
[[nodiscard]] std::vector<ShadowLamp> shadow_lamps(std::span<const scene::PlacedLamp> placed, const Lamps &lamps,
                                                   LampShading shading = LampShading::Whole);

/** The array textures of depths. All layers of an array have the size of the largest shadow in the array. */
enum class ShadowArrayId : std::uint8_t {
  Cubes,
  Maps,
  /** The six faces of the temporary cube for octahedral layers. All lamps use the same layers, one after the other. */
  DistanceCube,
};
inline constexpr std::size_t shadow_array_count = 3;

/** The resources that a technique requests for one lamp. */
struct ShadowRequest {
  ShadowArrayId array = ShadowArrayId::Cubes;
  /** Maximum number of layers in the array; for each viewport, if the technique's layers follow the view. */
  int layer_count_max = 0;
  /** Number of entries in the uniform block. */
  int entry_count = 1;
  /** Edge of each layer, texels. */
  int size_px = 0;
  /** Whether fewer layers may be larger, \see ShadowPlace::edge_max_px. */
  bool can_have_larger_layers = false;
  /** Edge of the octahedral layer without its border, texels. 0 if there is none. */
  int octahedral_px = 0;
  int octahedral_texel_bytes = 0;
};

/** The planned resources of one lamp's shadow. */
struct ShadowPlace {
  /** Index in the argument `lamps` of plan_shadows. */
  std::size_t lamp = 0;
  /** Index in ShadowPlan::places. */
  std::size_t index = 0;
  const ShadowTechnique *technique = nullptr;
  scene::ShadowKind kind = scene::ShadowKind::Hard;
  /** The request, with sizes reduced to the limits of the device and of the memory. */
  ShadowRequest given{};
  /**
   * The largest edge of a layer, texels. Above the size of the request, all layers have no more texels together than
   * requested. Lamps that share an array do not have larger layers, because its layers have one size.
   */
  int edge_max_px = 0;
  /** First entry in the uniform block, in the order of the lamps. A change of the entry does not invalidate layers. */
  int entry = 0;
  /** First layer in the array. -1 for maps: their layers are assigned later, as their number depends on the view. */
  int first_layer = 0;
};

struct ShadowPlan {
  /** In the order of the lamps. */
  std::vector<ShadowPlace> places;
  /** Layers in use of ShadowArrayId::Cubes. */
  LayerRuns cubes;
  /** Maximum number of layers of ShadowArrayId::Maps, including gaps between runs. */
  int map_layers_max = 0;
  /** Messages about settings of lamps that have no effect. */
  std::vector<std::string> warnings;
  /** Messages about lamps without a shadow and reduced sizes, with the limit that caused them. */
  std::vector<std::string> limits;
};

/**
 * Plan the shadows of \a lamps: their techniques, sizes and layers. Needs no device.
 *
 * The order of \a lamps is their priority. If a limit is exceeded, the last lamps lose their shadow. If the shadows
 * need more than ShadowSettings::memory_bytes_max, all sizes are reduced by the same factor (layers of one array have
 * one size), to at least 16 texels for depths and 4 texels for octahedral layers. If this does not suffice, the last
 * lamps lose their shadow.
 *
 * Sampled lamps without a size of their own have half the size of the settings, and smooth lamps a quarter, because
 * errors of the samples average out.
 *
 * \a viewport_count: number of viewports that draw the lamps. Each viewport has its own layers of techniques whose
 * layers follow the view.
 * \a previous: the last plan. Lamps keep their layers of cubes, unless the gaps of removed lamps would exceed the
 * memory or the device's number of layers. Then all cubes get new layers.
 *
 * \throws gpu::Error with the name of the lamp if the size of its shadow is out of range.
 */
[[nodiscard]] ShadowPlan plan_shadows(std::span<const ShadowLamp> lamps, const ShadowSettings &settings,
                                      const gpu::Limits &device_limits, const ShadowPlan &previous,
                                      int viewport_count = 1);

}  // namespace gnomon::eevee
