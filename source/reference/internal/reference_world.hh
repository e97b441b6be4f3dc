// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <vector>

namespace gnomon::reference {

/** A direction of a world, chosen by its light. */
struct WorldSample {
  /** Unit vector from the scene to the world; W/(sr m²); 1/sr. */
  glm::dvec3 to_world_ws{0.0, 1.0, 0.0};
  glm::dvec3 radiance{0.0};
  double density = 0.0;
};

/** Radiance of a scene's world, exactly as `doc/conventions.md` defines it, and directions by importance. */
class WorldSampler {
 public:
  /** \a world must outlive it. */
  explicit WorldSampler(const scene::World &world);

  /** No direction gives light. */
  [[nodiscard]] bool is_black() const
  {
    return !(sum_ > 0.0);
  }
  [[nodiscard]] glm::dvec3 radiance(const glm::dvec3 &to_world_ws) const;
  /** Probability density of sample(), 1/sr. */
  [[nodiscard]] double density(const glm::dvec3 &to_world_ws) const;
  /** For \a u in [0, 1)². \pre not black */
  [[nodiscard]] WorldSample sample(const glm::dvec2 &u) const;

 private:
  [[nodiscard]] glm::dvec2 place_of(const glm::dvec3 &to_world_ws) const;
  /** Radiance times solid angle of the texel at \a column, \a row. */
  [[nodiscard]] double weight(int column, int row) const;

  const scene::World &world_;
  /** The picture's size; 1 by 1 where there is none. */
  glm::ivec2 size_{1};
  /** Sums of each row up to each texel, and of rows up to each one. */
  std::vector<double> in_row_;
  std::vector<double> rows_;
  double sum_ = 0.0;
};

}  // namespace gnomon::reference
