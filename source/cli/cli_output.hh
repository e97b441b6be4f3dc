// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <set>
#include <span>
#include <string>

namespace gnomon::cli {

/**
 * Calls \a write for a temporary file in the same folder and renames it to \a path, so that \a path is complete or
 * unchanged. Exceptions of \a write are passed on, and the temporary file is removed.
 *
 * \throws std::runtime_error naming \a path if it cannot be written.
 */
void write_atomically(const std::filesystem::path &path,
                      const std::function<void(const std::filesystem::path &beside)> &write);

/**
 * Removes the temporary files that write_atomically left in \a folder because its process was killed. Only those of
 * files in \a names, and none of a process that runs on this machine.
 */
void remove_unfinished(const std::filesystem::path &folder, const std::set<std::string> &names);

/** Non-finite values of a picture. */
struct NonFinite {
  /** Number of channels that are NaN or infinite. */
  std::size_t count = 0;
  /** The first such pixel, from the upper left. \pre count > 0 */
  glm::ivec2 first_px{0};
};

/** \a values: \a channel_count floats for each pixel, rows from the bottom. */
[[nodiscard]] NonFinite find_non_finite(glm::ivec2 size_px, std::span<const float> values,
                                        std::size_t channel_count = 4);

/** The components of \a pixels. */
[[nodiscard]] inline std::span<const float> floats(std::span<const glm::vec4> pixels)
{
  return {reinterpret_cast<const float *>(pixels.data()), 4 * pixels.size()};
}

/** Writes the file atomically. \throws std::runtime_error naming \a path if it cannot be written. */
void write_text(const std::filesystem::path &path, const std::string &text);

}  // namespace gnomon::cli
