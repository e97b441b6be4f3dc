// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_lamps.hh"

#include "render_world.hh"

#include <glm/mat4x4.hpp>

#include <cstdint>
#include <memory>
#include <optional>

namespace gnomon::eevee {

/** A point of a lamp, which stands for all of it in one sample of a picture. */
struct LampPoint {
  /** In light_block. */
  int light = 0;
  /** The lamp, moved to the point; of a sun, turned to a direction of it. */
  glm::mat4 world_from_lamp{1.0F};
  /** Distance of the point from the lamp's centre, metres. 0 for a sun. */
  float offset = 0.0F;
  /** As LightData has them. */
  glm::vec3 color{0.0F};
  float radius_sq = 0.0F;
};

/** Whether \a lamp is more than a point or a single direction. */
[[nodiscard]] bool has_extent(const scene::Lamp &lamp);

/**
 * The point of \a lamp for the place \a place in [0, 1)³; the mean over all places is the lamp. \a toward_ws: where
 * most receivers are; points are spread most evenly as seen from there.
 *
 * A point lamp and a spot are the disk of their radius r that is turned to each receiver. Points in the ball of density
 * ∝ (r² - ρ²)^(-1/2) are spread evenly over that disk from every side. With the fall-off 1 / (d² + r²) from the point,
 * a mean over the ball is too small by 1.25 (r / d)⁴ of it: by 1e-4 at d = 10.6 r.
 *
 * An area lamp is spread evenly over its rectangle or ellipse.
 *
 * A sun is a cone of one radiance: directions are spread evenly over its solid angle.
 */
[[nodiscard]] glm::mat4 point_of(const scene::PlacedLamp &lamp, const glm::vec3 &place, const glm::vec3 &toward_ws);

/** Of each light of \a lamps that has an extent. */
class LampPoints {
 public:
  LampPoints() = default;
  /**
   * \a world: of the last lamps in \a placed, those that world_lamps gave; nullptr: there is none.
   * \a sample_count: of the picture.
   */
  LampPoints(std::span<const scene::PlacedLamp> placed, const Lamps &lamps, const glm::vec3 &toward_ws,
             std::shared_ptr<const render_scene::WorldLight> world = {}, int sample_count = 1);

  [[nodiscard]] bool empty() const
  {
    return sized_.empty();
  }
  [[nodiscard]] std::size_t size() const
  {
    return sized_.size();
  }
  /** The points of a sample; the same for the same \a seed. The result is valid until the next call. */
  [[nodiscard]] std::span<const LampPoint> sample(std::uint32_t index, std::uint32_t seed);
  /** The lamps' centres. Valid as above. */
  [[nodiscard]] std::span<const LampPoint> centers();

 private:
  struct Sized {
    int light = 0;
    scene::PlacedLamp lamp;
    /** As the lamp's centre has them. */
    glm::vec3 color{0.0F};
    float radius_sq = 0.0F;
    /** Of a lamp that stands for a part of the world; otherwise nullptr. */
    const render_scene::WorldDistribution *world = nullptr;
    /** Of the directions that share a distribution in one sample. */
    std::uint32_t direction = 0;
    std::uint32_t direction_count = 1;
  };
  [[nodiscard]] LampPoint world_point(const Sized &sized, std::uint32_t index, std::uint32_t seed) const;

  std::shared_ptr<const render_scene::WorldLight> world_;
  std::vector<Sized> sized_;
  std::vector<LampPoint> points_;
  int sample_count_ = 1;
  glm::vec3 toward_ws_{0.0F};
};

/** \a light as \a point has it. */
[[nodiscard]] shared::LightData light_at(shared::LightData light, const LampPoint &point);

}  // namespace gnomon::eevee
