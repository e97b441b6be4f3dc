// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec3.hpp>

#include <cstddef>
#include <memory>
#include <vector>

namespace gnomon::scene {

/** Radiance from all directions, W/(sr m²), as an equirectangular picture. */
struct WorldPicture {
  /** Both above 0. */
  int width = 0;
  int height = 0;
  /**
   * width · height texels, finite and at least 0, rows from the top. The direction (x, y, z) in glTF's axes is at
   * u = 0.5 + atan2(z, x) / 2π from the left and v = 0.5 + asin(y) / π from the bottom.
   */
  std::vector<glm::vec3> texels{};

  [[nodiscard]] const glm::vec3 &at(int x, int y) const
  {
    return texels[std::size_t(y) * std::size_t(width) + std::size_t(x)];
  }
};

/** Light from infinitely far away, from every direction. */
struct World {
  /** Linear: the radiance where there is no picture, and a factor of the picture. */
  glm::vec3 color{1.0F};
  float strength = 1.0F;
  /** Turns the picture around the y axis, radians: what was at +x comes to -z at π/2. */
  float rotation = 0.0F;
  /** nullptr: the same radiance from everywhere. */
  std::shared_ptr<const WorldPicture> picture{};

  bool operator==(const World &) const = default;
};

}  // namespace gnomon::scene
