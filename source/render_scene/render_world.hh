// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <glm/vec2.hpp>

#include <array>
#include <span>
#include <vector>

namespace gnomon::render_scene {

/**
 * Unit vector of a point of an equirectangular picture. \a u in [0, 1] from the left, \a v in [0, 1] from the bottom.
 * \see scene::WorldPicture
 */
[[nodiscard]] glm::dvec3 direction_of(double u, double v);
/** Solid angle in sr of a texel in row \a y, counted from the bottom, of a picture of \a width by \a height texels. */
[[nodiscard]] double texel_solid_angle(int y, int width, int height);

/** A sampled direction of a world. */
struct WorldDirection {
  /** Unit vector from the scene to the world. */
  glm::dvec3 to_world{0.0, 1.0, 0.0};
  /** Radiance divided by the probability density, W/m²: irradiance of a surface perpendicular to the direction. */
  glm::dvec3 irradiance{0.0};
  /** 1 divided by the probability density, sr: the solid angle that the sample represents. */
  double solid_angle = 0.0;
};

/** Samples directions of an equirectangular picture with a density that follows its luminance. */
class WorldDistribution {
 public:
  struct Texel {
    /** Column from the left and row from the bottom. */
    int x = 0;
    int y = 0;
    glm::vec3 radiance{0.0F};
  };
  WorldDistribution() = default;
  /**
   * \a size: the size of the picture. \a texels: the sampled texels, sorted by row and then by column. \a even_share:
   * the fraction of the samples, in [0, 1], that are distributed uniformly over the solid angle of the texels.
   * \a importance: empty, or for each texel a factor of its density, at least 0. The light is the same with any
   * factors, as each direction has the radiance divided by its density: texels with light need a factor above 0.
   */
  WorldDistribution(glm::ivec2 size, std::vector<Texel> texels, double even_share,
                    std::span<const float> importance = {});

  /** Whether all texels are black. */
  [[nodiscard]] bool empty() const
  {
    return texels_.empty();
  }
  /** Effective solid angle, sr: (∫ L dω)² / ∫ L² dω for the luminance L. Equals that of a uniformly bright disk. */
  [[nodiscard]] double solid_angle() const
  {
    return solid_angle_;
  }
  /**
   * The direction for the random numbers \a place in [0, 1)². The mean irradiance over all places is the integral of
   * the radiance over the texels. \pre not empty
   */
  [[nodiscard]] WorldDirection at(const glm::dvec2 &place) const;

 private:
  /** The texels [first, end) of one row, and the sum of the weights of all texels before `end`. */
  struct Row {
    std::size_t first = 0;
    std::size_t end = 0;
    double cumulative = 0.0;
  };
  glm::ivec2 size_{0};
  double solid_angle_ = 0.0;
  std::vector<Texel> texels_;
  /** For each texel, the sum of the weights of its row up to and including this texel. */
  std::vector<double> cumulative_;
  std::vector<Row> rows_;
};

/**
 * The light of a world, split for rendering. Small bright regions of the picture become suns, which cast shadows. The
 * other texels are the rest. The sum of the suns and the rest is the world.
 */
struct WorldLight {
  /** Size of `rest` and of the pictures of prefiltered(), in texels. */
  static constexpr glm::ivec2 size{256, 128};
  /** Maximum number of suns. */
  static constexpr int sun_max = 8;

  struct Sun {
    /** A sun lamp with the irradiance and the effective solid angle of the region. */
    scene::PlacedLamp lamp;
    /** The region of the picture. */
    WorldDistribution directions;
  };
  /** Sorted by light, brightest first. */
  std::vector<Sun> suns;
  /** Radiance of the rest as an equirectangular picture, rows from the bottom. Texels of suns are black. */
  std::vector<glm::vec3> rest;
  /** Empty if the rest is black. \see rest_distribution */
  WorldDistribution rest_directions;
  /**
   * Irradiance of the rest divided by π, in real spherical harmonics up to order 2 (Ramamoorthi and Hanrahan 2001). The
   * constants of the basis are multiplied in: these are the coefficients of the polynomials 1, y, z, x, xy, yz,
   * 3z² - 1, xz and x² - y² of the normal.
   */
  std::array<glm::vec3, 9> harmonics{};

  [[nodiscard]] bool is_black() const
  {
    return suns.empty() && rest_directions.empty();
  }
};

/** Distribution of directions over \a rest, a picture like WorldLight::rest. \a importance: \see WorldDistribution */
[[nodiscard]] WorldDistribution rest_distribution(std::span<const glm::vec3> rest,
                                                  std::span<const float> importance = {});

/** Splits \a world into suns and the rest. */
[[nodiscard]] WorldLight world_light(const scene::World &world);

/**
 * Filters \a picture, of WorldLight::size, with the GGX lobe of each of \a level_count roughness levels, for a view
 * along the normal. The roughness of a level is level / (level_count - 1). Level 0 is the unfiltered picture.
 */
[[nodiscard]] std::vector<std::vector<glm::vec3>> prefiltered(std::span<const glm::vec3> picture, int level_count);

}  // namespace gnomon::render_scene
