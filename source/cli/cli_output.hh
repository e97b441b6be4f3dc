// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gnomon::cli {

/**
 * Let \a write make a file beside \a path, then rename it to \a path: there is the whole file or none.
 * What \a write throws passes through, and leaves nothing behind.
 *
 * \throws std::runtime_error naming \a path where it cannot be made.
 */
void write_atomically(const std::filesystem::path &path,
                      const std::function<void(const std::filesystem::path &beside)> &write);

/** A file of \a text, whole or not at all. \throws as write_atomically */
void write_text(const std::filesystem::path &path, const std::string &text);

/** What is wrong with a picture's numbers. */
struct NonFinite {
  /** Channels that are NaN or infinite. */
  std::size_t count = 0;
  /** The first such pixel, from the upper left; meaningless while count is 0. */
  glm::ivec2 first_px{0};
};

/** \a rgba: four floats a pixel, rows from the bottom. */
[[nodiscard]] NonFinite find_non_finite(glm::ivec2 size_px, std::span<const float> rgba);

/** Names and values for an image's header. */
using Metadata = std::vector<std::pair<std::string, std::string>>;

/** RGB, 32-bit float, rows from the bottom, four floats a pixel of which the last is dropped. */
void write_exr(const std::filesystem::path &path, glm::ivec2 size_px, std::span<const float> rgba,
               const Metadata &metadata);
/** RGB, 8 bits, rows from the bottom, four bytes a pixel of which the last is dropped. */
void write_png(const std::filesystem::path &path, glm::ivec2 size_px, std::span<const std::uint8_t> rgba,
               const Metadata &metadata);

}  // namespace gnomon::cli
