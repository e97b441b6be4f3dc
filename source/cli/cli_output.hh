// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
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

/** What is wrong with a picture's numbers. */
struct NonFinite {
  /** Channels that are NaN or infinite. */
  std::size_t count = 0;
  /** The first such pixel, from the upper left; meaningless while count is 0. */
  glm::ivec2 first_px{0};
};

/** \a rgba: four floats a pixel, rows from the bottom. */
[[nodiscard]] NonFinite find_non_finite(glm::ivec2 size_px, std::span<const float> rgba);

/** The same numbers, one by one. */
[[nodiscard]] inline std::span<const float> floats(std::span<const glm::vec4> pixels)
{
  return {reinterpret_cast<const float *>(pixels.data()), 4 * pixels.size()};
}

/** Names and values for an image's header. */
using Metadata = std::vector<std::pair<std::string, std::string>>;

/** RGB, 32-bit float, rows from the bottom, four floats a pixel of which the last is dropped. */
void write_exr(const std::filesystem::path &path, glm::ivec2 size_px, std::span<const float> rgba,
               const Metadata &metadata);
/** RGB, 8 bits, rows from the bottom, four bytes a pixel of which the last is dropped. */
void write_png(const std::filesystem::path &path, glm::ivec2 size_px, std::span<const std::uint8_t> rgba,
               const Metadata &metadata);

/** Whole, or not at all. \throws std::runtime_error naming \a path where it cannot be written. */
void write_text(const std::filesystem::path &path, const std::string &text);

/**
 * Red, green, blue and 1, rows from the bottom, as write_exr has written them.
 * \throws std::runtime_error naming \a path where it cannot be read or is of another size.
 */
[[nodiscard]] std::vector<glm::vec4> read_exr(const std::filesystem::path &path, glm::ivec2 size_px);
/** A picture of any size. */
struct Picture {
  glm::ivec2 size_px{0};
  /** Scene-linear red, green, blue and 1, rows from the bottom. */
  std::vector<glm::vec4> pixels;
};
/**
 * Read an image of any format that OpenImageIO knows; integers are decoded by the sRGB curve. Of an EXR with layers,
 * the channels R, G and B. \throws std::runtime_error naming \a path where it cannot be read or has no R, G and B.
 */
[[nodiscard]] Picture read_picture(const std::filesystem::path &path);
/** A PNG file, as write_png writes it, without metadata. */
[[nodiscard]] std::vector<std::byte> png_bytes(glm::ivec2 size_px, std::span<const std::uint8_t> rgba);

}  // namespace gnomon::cli
