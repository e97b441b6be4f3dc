// SPDX-License-Identifier: MIT
#pragma once

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
   * width · height texels, finite and at least 0, rows from the top. The unit vector (x, y, z), in glTF's axes, is at
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

/** Light from infinitely distant surroundings. The radiance is `color` · `strength` · `picture`. */
struct World {
  /** Linear colour. */
  glm::vec3 color{1.0F};
  float strength = 1.0F;
  /** Rotation of the picture around the y axis, radians. A rotation by π/2 moves the texel at +x to -z. */
  float rotation = 0.0F;
  /** nullptr: the radiance is the same in all directions, `color` · `strength`. */
  std::shared_ptr<const WorldPicture> picture{};

  bool operator==(const World &) const = default;
};

/** Why Scene::set_world refuses \a world; empty: it does not. */
[[nodiscard]] std::string fault_of(const World &world);

}  // namespace gnomon::scene
