// SPDX-License-Identifier: MIT
#pragma once

#include "output_roles.hh"

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <nlohmann/json_fwd.hpp>

#include <cstddef>
#include <filesystem>
#include <span>

namespace gnomon::cli {

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

/**
 * Writes \a json by output::write_file, unless \a path is empty. Invalid UTF-8, as names of files may have it, becomes
 * U+FFFD. \a indent: spaces
 */
void write_json(const std::filesystem::path &path, const nlohmann::json &json, int indent = 2);

/**
 * If an output of \a files is standard output itself, as with `--json /dev/stdout`, text for stdout goes to stderr from
 * now on.
 */
void keep_text_from(const output::Roles &files);

}  // namespace gnomon::cli
