// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

/** Write a picture as a PPM file. \a rgba: four bytes a pixel, rows from the bottom; alpha is left out. */
inline void write_ppm(const std::string &path, int width, int height, const std::vector<std::byte> &rgba)
{
  std::ofstream file(path, std::ios::binary);
  file << "P6\n" << width << ' ' << height << "\n255\n";
  for (int y = height - 1; y >= 0; y--) {
    for (int x = 0; x < width; x++) {
      file.write(reinterpret_cast<const char *>(&rgba[4 * (std::size_t(y) * std::size_t(width) + std::size_t(x))]), 3);
    }
  }
  if (!file.flush()) {
    throw std::runtime_error(path + ": cannot be written");
  }
}
