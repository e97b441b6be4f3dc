// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec4.hpp>

#include <cstdio>
#include <cstdlib>
#include <span>

/**
 * Write \a texels as floats to the file \a path, for embedding. The values are rounded to seven digits, so that
 * compilers that differ in the last bits of a sum write the same file. \return the program's status: 0, or 1 with a
 * message
 */
inline int write_table(const char *path, std::span<const glm::dvec4> texels)
{
  std::FILE *file = std::fopen(path, "wb");
  bool is_written = file != nullptr;
  for (std::size_t i = 0; is_written && i < 4 * texels.size(); i++) {
    char digits[32];
    std::snprintf(digits, sizeof(digits), "%.6e", texels[i / 4][int(i % 4)] + 0.0);
    const float value = std::strtof(digits, nullptr);
    is_written = std::fwrite(&value, sizeof(value), 1, file) == 1;
  }
  is_written = file && std::fclose(file) == 0 && is_written;
  if (!is_written) {
    std::perror(path);
  }
  return is_written ? 0 : 1;
}
