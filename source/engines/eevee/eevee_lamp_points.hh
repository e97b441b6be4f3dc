// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_lamps.hh"
#include "eevee_world.hh"
#include "eevee_world_shared.h"

#include "render_world.hh"
#include "scene_emission.hh"

#include <glm/mat4x4.hpp>

#include <cstdint>
#include <memory>
#include <optional>

namespace gnomon::eevee {

/** A point of a lamp with an extent. In one sample of a picture, the point replaces the lamp. */
struct LampPoint {
  /** Index in Lamps::lights. */
  int light = 0;
  /** Matrix of the lamp, moved to the point. For a sun, rotated to a direction within its cone. */
  glm::mat4 world_from_lamp{1.0F};
  /** Distance of the point from the lamp's centre, metres. 0 for a sun. */
  float offset = 0.0F;
  /** Values of the members of LightData with the same names. */
  glm::vec3 color{0.0F};
  float radius_sq = 0.0F;
};

/** The points of one sample, which replace their lamps. It refers to nothing else. */
struct SampledLampPoints {
  /** In the order of the lights. */
  std::vector<LampPoint> points{};
  /**
   * WORLD_SUN_POINTS points of each sun of the world. They differ from the one point that has a shadow. Empty for the
   * centres of lamps.
   */
  std::vector<shared::WorldSunPoint> sun_points{};
  /** Index in Lamps::lights of the first sun of the world, which the others follow. Undefined without sun_points. */
  int first_sun = 0;
};

/** Whether \a lamp has an extent: a point or spot with a radius, a sun with an angle, or an area lamp. */
[[nodiscard]] bool has_extent(const scene::Lamp &lamp);

/**
 * The matrix of \a lamp for the sample position \a place in [0, 1)³. The mean over all positions converges to the light
 * of the whole lamp. \a toward_ws: centre of the receivers. Stratified positions stay stratified on the disk that faces
 * this point.
 *
 * Point lamps and spots: for each receiver, the lamp is a disk of radius r that faces the receiver. Points in the ball
 * of radius r with a density ∝ (r² - ρ²)^(-1/2) project to a uniform distribution on this disk from every direction.
 * With the fall-off 1 / (d² + r²) from the point, the mean over the ball is too small by the fraction 1.25 (r / d)⁴,
 * for example 1e-4 at d = 10.6 r.
 *
 * Area lamps: points have a uniform distribution over the rectangle or ellipse.
 *
 * Suns: the lamp is a cone of constant radiance. Directions have a uniform distribution over its solid angle.
 */
[[nodiscard]] glm::mat4 point_of(const scene::PlacedLamp &lamp, const glm::vec3 &place, const glm::vec3 &toward_ws);

/** Selects the sequence of points of the lamp number \a lamp; for lamps that share a sequence, of the first of them. */
[[nodiscard]] std::uint32_t lamp_stream(std::uint32_t seed, std::size_t lamp);

/**
 * A point of emissive surfaces. \a index: of the point among those of all samples, of which each has \a count.
 * \a stream: selects the sequence of points. \a sample_count: samples for each pixel of the picture.
 */
[[nodiscard]] LampPoint emissive_point(const scene::EmissiveSurfaces &surfaces, std::uint32_t index,
                                       std::uint32_t stream, int count, int sample_count);

/** Samples points of all lamps with an extent. */
class LampPoints {
 public:
  LampPoints() = default;
  /**
   * \a placed: the list from which \a lamps was made. \a toward_ws: centre of the receivers, \see point_of.
   * \a world: the world whose world_lamps are the last entries of \a placed; nullptr if there is none.
   * \a directions: those of its rest.
   * \a sample_count: samples for each pixel of the picture.
   * \a emission: the surfaces of which the emission_lamps before these are points; nullptr if there are none.
   * \a emission_count: number of these lamps.
   */
  LampPoints(std::span<const scene::PlacedLamp> placed, const Lamps &lamps, const glm::vec3 &toward_ws,
             std::shared_ptr<const render_scene::WorldLight> world = {}, const WorldDirections &directions = {},
             int sample_count = 1, std::shared_ptr<const scene::EmissiveSurfaces> emission = {},
             int emission_count = 0);

  [[nodiscard]] bool empty() const
  {
    return sized_.empty();
  }
  [[nodiscard]] std::size_t size() const
  {
    return sized_.size();
  }
  /** The points of the \a index-th sample. Deterministic. \a memory: an earlier result, whose memory is used again */
  [[nodiscard]] SampledLampPoints sample(std::uint32_t index, std::uint32_t seed, SampledLampPoints memory = {}) const;
  /** The centres of the lamps. */
  [[nodiscard]] SampledLampPoints centers() const;
  /** The directions of the samples of a picture. */
  [[nodiscard]] RestDirections rest_directions(std::uint32_t seed) const;

 private:
  struct Sized {
    int light = 0;
    /** Index of the lamp in `placed`. */
    std::uint32_t index = 0;
    scene::PlacedLamp lamp;
    /** Values of LightData for the lamp's centre. */
    glm::vec3 color{0.0F};
    float radius_sq = 0.0F;
    /** Distribution of directions, for a lamp of world_lamps; otherwise nullptr. */
    const render_scene::WorldDistribution *world = nullptr;
    /** A point of emissive surfaces. */
    bool is_emission = false;
    /** Index and number of the lamps that share the distribution of directions or points. */
    std::uint32_t direction = 0;
    std::uint32_t direction_count = 1;
  };
  /** The sequence of the lamps that share the distribution of \a sized. */
  [[nodiscard]] static std::uint32_t stream_of(const Sized &sized, std::uint32_t seed);
  static void add_sun_points(const Sized &sized, std::uint32_t index, std::uint32_t seed, SampledLampPoints &sampled);
  [[nodiscard]] LampPoint world_point(const Sized &sized, std::uint32_t index, std::uint32_t seed) const;

  std::shared_ptr<const render_scene::WorldLight> world_;
  WorldDirections directions_;
  std::shared_ptr<const scene::EmissiveSurfaces> emission_;
  std::vector<Sized> sized_;
  int sample_count_ = 1;
  glm::vec3 toward_ws_{0.0F};
};

/** \a light with the position, the direction, the colour and the radius of \a point. */
[[nodiscard]] shared::LightData light_at(shared::LightData light, const LampPoint &point);

}  // namespace gnomon::eevee
