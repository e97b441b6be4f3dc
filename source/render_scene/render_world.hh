// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <glm/vec2.hpp>

#include <array>
#include <span>
#include <vector>

namespace gnomon::render_scene {

/** Unit vector at \a u from the left and \a v from the bottom of an equirectangular picture. */
[[nodiscard]] glm::dvec3 direction_of(double u, double v);
/** Solid angle of a texel in row \a y from the bottom of \a height, sr. */
[[nodiscard]] double texel_solid_angle(int y, int width, int height);

/** A direction that stands for a part of a world. */
struct WorldDirection {
  /** Unit vector from the scene to the world. */
  glm::dvec3 to_world{0.0, 1.0, 0.0};
  /** Irradiance on a surface that faces it, W/m²: radiance over density. */
  glm::dvec3 irradiance{0.0};
  /** Solid angle that it stands for, sr: 1 over density. */
  double solid_angle = 0.0;
};

/** Directions in proportion to the light of some texels of an equirectangular grid. */
class WorldDistribution {
 public:
  struct Texel {
    /** From the left and from the bottom. */
    int x = 0;
    int y = 0;
    glm::vec3 radiance{0.0F};
  };
  WorldDistribution() = default;
  /**
   * \a texels: row by row. \a even_share: in [0, 1], of the directions that are spread evenly over the texels' solid
   * angle; the others go by luminance.
   */
  WorldDistribution(glm::ivec2 size, std::vector<Texel> texels, double even_share);

  /** No texel gives light. */
  [[nodiscard]] bool empty() const
  {
    return texels_.empty();
  }
  /** Of a disk of one radiance that gives as much light, sr. */
  [[nodiscard]] double solid_angle() const
  {
    return solid_angle_;
  }
  /** For \a place in [0, 1)². The mean over all places is the light of the texels. \pre not empty */
  [[nodiscard]] WorldDirection at(const glm::dvec2 &place) const;

 private:
  /** Texels of one row: the first, and the sum of weights up to the end of the row. */
  struct Row {
    std::size_t first = 0;
    std::size_t end = 0;
    double cumulative = 0.0;
  };
  glm::ivec2 size_{0};
  double solid_angle_ = 0.0;
  std::vector<Texel> texels_;
  /** Of the texels of a row up to each one. */
  std::vector<double> cumulative_;
  std::vector<Row> rows_;
};

/**
 * A world as an engine lights a scene with it: suns in the place of what is small and bright, which cast shadows, and a
 * smooth rest. Both together are the world.
 */
struct WorldLight {
  /** Texels of `rest`, which `prefiltered` gives too. */
  static constexpr glm::ivec2 size{256, 128};
  /** Most suns. */
  static constexpr int sun_max = 8;

  struct Sun {
    /** Its angle is that under which a disk of one radiance gives as much light. */
    scene::PlacedLamp lamp;
    /** The sun as the picture has it. */
    WorldDistribution directions;
  };
  /** The brightest first. */
  std::vector<Sun> suns;
  /** The world without its suns, equirectangular, rows from the bottom. Where a sun was it is black. */
  std::vector<glm::vec3> rest;
  /** Empty where the rest is black. */
  WorldDistribution rest_directions;
  /**
   * Irradiance of the rest over π, in real spherical harmonics up to the second order: with the basis of Ramamoorthi
   * and Hanrahan (2001) multiplied in, so that it is a polynomial 1, y, z, x, xy, yz, 3z² - 1, xz, x² - y² of the
   * normal.
   */
  std::array<glm::vec3, 9> harmonics{};

  [[nodiscard]] bool is_black() const
  {
    return suns.empty() && rest_directions.empty();
  }
};

[[nodiscard]] WorldLight world_light(const scene::World &world);

/**
 * A picture of WorldLight::size as a mirror of rising roughness shows it, seen along the normal: one for each of
 * \a level_count levels, of roughness level / (level_count - 1). Level 0 is the picture itself.
 */
[[nodiscard]] std::vector<std::vector<glm::vec3>> prefiltered(std::span<const glm::vec3> picture, int level_count);

}  // namespace gnomon::render_scene
