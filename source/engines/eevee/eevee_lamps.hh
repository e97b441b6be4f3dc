// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_features.hh"

#include "eevee_light_cluster_shared.h"
#include "eevee_light_shared.h"
#include "scene.hh"

#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace gnomon::eevee {

/** How lamps with a radius, an angle or an area are shaded. */
enum class LampShading {
  /** Closed-form shading of the whole lamp. */
  Whole,
  /** Shading of one point of the lamp, at the position in LightData. The mean over many points gives the whole lamp. */
  Point,
};

/** Text for messages: the first ten of \a names in quotes, and the number of the others. */
[[nodiscard]] std::string listed(std::span<const std::string> names);

/** The lamp in the layout of the shaders, without its shadow. SceneShadows::sync writes the members of the shadow. */
[[nodiscard]] shared::LightData light_data(const scene::PlacedLamp &lamp);
/** The extent and axes of a lamp in the layout of the shaders. */
[[nodiscard]] shared::LightShape light_shape(const scene::PlacedLamp &lamp, LampShading shading);
/** Half angle of the smallest circular cone that contains a spot's elliptical cone, radians. */
[[nodiscard]] float widest_half_angle(const scene::PlacedLamp &lamp);

/** Let \a light give no light. Its shadow and its points stay as they are. */
void leave_out(shared::LightData &light);

/** A sphere that contains all points which a light can reach. World space, metres. */
struct LightReach {
  glm::vec3 center_ws{0.0F};
  /** Infinite: the light reaches everywhere. */
  float radius = std::numeric_limits<float>::infinity();

  [[nodiscard]] bool is_everywhere() const
  {
    return std::isinf(radius);
  }
  bool operator==(const LightReach &) const = default;
};

/**
 * Lower the range of \a lamp to the distance beyond which its irradiance is at most \a threshold, W/m², if that is
 * above 0. As the window of the range is a factor of 1 - (distance / range)⁴, the irradiance at no point is lowered by
 * more than that. Only for points and spots: in one frame, the light of an area lamp has no window, and would end at an
 * edge.
 */
void lower_range(scene::PlacedLamp &lamp, float threshold);

/**
 * The reach of a lamp: its range, and within that the cone of a spot. Suns, hemis and lamps without a range reach
 * everywhere. LampShading::Point: from all points of the lamp.
 */
[[nodiscard]] LightReach light_reach(const scene::PlacedLamp &lamp, LampShading shading);

/** The data of all lamps that give light, in the layout of the shaders. */
struct Lamps {
  /** First those whose shadows may be cubes, then the others; in both groups, first those that reach everywhere. */
  std::vector<shared::LightData> lights;
  /** One for each light. Read by the shaders only with Feature::LampShape. */
  std::vector<shared::LightShape> shapes;
  /** One for each light. */
  std::vector<LightReach> reaches;
  /** \see shared::LightClusterBlock for the members with the same names. */
  int cube_light_count = 0;
  int cube_everywhere_count = 0;
  int other_everywhere_count = 0;
  /** The last lights are these points. \see add_surface_points */
  int surface_point_count = 0;
  /** For each light, the index of its lamp in the argument of make_lamps. */
  std::vector<std::uint32_t> lamp_index;
  /** Features that the lamps need, without those of shadows. */
  Feature features = Feature::None;
  /** Specular lobes of this alpha and wider ones reflect no lamp as a whole. \see set_highlights */
  float highlight_alpha = 0.0F;
  /** One message for each lamp that cannot be drawn. */
  std::vector<std::string> warnings;
  /** A message that names the lamps that exceed the limit. */
  std::vector<std::string> limits;

  [[nodiscard]] int light_count() const
  {
    return int(lights.size());
  }
  /** Number of lights that do not reach everywhere. */
  [[nodiscard]] int local_count() const
  {
    return light_count() - surface_point_count - cube_everywhere_count - other_everywhere_count;
  }
};

/**
 * The data of \a lamps: lamps with has_cube, then the others. In each group, lamps without a range come first;
 * otherwise the order of \a lamps is kept. Lamps that give no light (black, intensity 0, no area) and lamps after \a
 * light_count_max lights get no entry.
 */
[[nodiscard]] Lamps make_lamps(std::span<const scene::PlacedLamp> lamps, LampShading shading = LampShading::Whole,
                               std::size_t light_count_max = LIGHT_COUNT_MAX);

/**
 * Let the lamps with an extent whose index is below \a end have highlights as a whole, in a picture of \a sample_count
 * samples. \a placed: the argument of make_lamps, with LampShading::Point. \a receivers_ws: a box around all surfaces.
 */
void set_highlights(Lamps &lamps, std::span<const scene::PlacedLamp> placed, std::size_t end, int sample_count,
                    const scene::Bounds &receivers_ws);

/**
 * Append lights for those of \a placed from \a first on, which are points of emissive surfaces without shadows.
 * Programs visit them in a loop of their own, which has no lookups of shadows. \see eevee_light_lib.glsl
 */
void add_surface_points(Lamps &lamps, std::span<const scene::PlacedLamp> placed, std::size_t first);

/** Set LightData::kind of the lights of lamps whose index is at least \a first and below \a end. */
void set_kind(Lamps &lamps, std::size_t first, std::size_t end, std::int32_t kind);

/**
 * First indices of handles of lamps without a node: those of the world and those of emissive surfaces. Kept shadows are
 * found by these handles. Each range has 256 indices. No pool uses them.
 */
inline constexpr std::uint32_t world_node_first = 0xffffff00U;
inline constexpr std::uint32_t emission_node_first = 0xfffffe00U;

}  // namespace gnomon::eevee
