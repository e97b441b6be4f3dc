// SPDX-License-Identifier: MIT
#pragma once

#include "scene_property.hh"

#include <glm/vec3.hpp>

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace gnomon::scene {

/** Radiance from all directions in W/(sr m²) as an equirectangular picture. */
struct WorldPicture {
  /** Size in texels; both greater than 0. */
  int width = 0;
  int height = 0;
  /**
   * width · height texels from 0 to 1e30, rows from the top. The unit vector (x, y, z), in glTF's axes, is at
   * u = 0.5 + atan2(z, x) / 2π from the left and v = 0.5 + asin(y) / π from the bottom.
   */
  std::vector<glm::vec3> texels{};
  /** The file that the picture was read from. A scene that is written refers to it. Empty: there is none. */
  std::string path{};

  /** The texel in column \a x from the left and row \a y from the top. */
  [[nodiscard]] const glm::vec3 &at(int x, int y) const
  {
    return texels[std::size_t(y) * std::size_t(width) + std::size_t(x)];
  }
};

/** Light from infinitely distant surroundings. The radiance is `color` · `strength` · `picture`, at most 1e30. */
struct World {
  static constexpr std::string_view kind_name = "world";

  glm::vec3 color{1.0F};
  float strength = 1.0F;
  float rotation = 0.0F;
  /** nullptr: the radiance is the same in all directions, `color` · `strength` W/(sr m²). */
  std::shared_ptr<const WorldPicture> picture{};

  bool operator==(const World &) const = default;

  /** Visits the rows of all members but `picture`. */
  template <typename Visit>
  static constexpr void for_each_property(Visit &&visit);
};

template <typename Visit>
constexpr void World::for_each_property(Visit &&visit)
{
  visit(property(&World::color,
                 {.name = "color",
                  .label = "Color",
                  .max = light_max,
                  .sentence = "Linear red, green and blue: factors of the picture, or without a picture a radiance, "
                              "W/(sr m²)."}));
  visit(property(&World::strength,
                 {.name = "strength", .label = "Strength", .max = light_max, .sentence = "Factor of the colour."}));
  visit(
      property(&World::rotation,
               {.name = "rotation",
                .label = "Rotation",
                .unit = "rad",
                .min = -number_max,
                .sentence = "Angle by which the picture turns around the y axis. At π/2, the texel at +x is at -z."}));
}

/**
 * Makes all texels radiances: negative and undefined values become 0, infinite ones the largest finite value of their
 * channel, and none is above 1e30. \return what was changed, with the number and the first place of each kind, for a
 * warning; empty: nothing.
 */
[[nodiscard]] std::string clamp_radiances(WorldPicture &picture);
/**
 * Makes all radiances, with the color and the strength, at most 1e30: changes a copy of the picture, or the color.
 * \return as clamp_radiances
 */
[[nodiscard]] std::string limit_radiances(World &world);

/** Why Scene::set_world refuses \a world; empty: it does not. */
[[nodiscard]] std::string fault_of(const World &world);

}  // namespace gnomon::scene
