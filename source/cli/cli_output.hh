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
 * Calls \a write for a temporary file in the same folder and renames it to \a path, so that \a path is complete or
 * unchanged. Exceptions of \a write are passed on, and the temporary file is removed.
 *
 * \throws std::runtime_error naming \a path if it cannot be written.
 */
void write_atomically(const std::filesystem::path &path,
                      const std::function<void(const std::filesystem::path &beside)> &write);

/** Non-finite values of a picture. */
struct NonFinite {
  /** Number of channels that are NaN or infinite. */
  std::size_t count = 0;
  /** The first such pixel, from the upper left. \pre count > 0 */
  glm::ivec2 first_px{0};
};

/** \a rgba: four floats for each pixel, rows from the bottom. */
[[nodiscard]] NonFinite find_non_finite(glm::ivec2 size_px, std::span<const float> rgba);

/** The components of \a pixels. */
[[nodiscard]] inline std::span<const float> floats(std::span<const glm::vec4> pixels)
{
  return {reinterpret_cast<const float *>(pixels.data()), 4 * pixels.size()};
}

/** Names and values for an image's header. */
using Metadata = std::vector<std::pair<std::string, std::string>>;

/** Writes RGB as 32-bit floats. Rows from the bottom, four floats for each pixel; the fourth is dropped. */
void write_exr(const std::filesystem::path &path, glm::ivec2 size_px, std::span<const float> rgba,
               const Metadata &metadata);
/** Writes RGB with 8 bits. Rows from the bottom, four bytes for each pixel; the fourth is dropped. */
void write_png(const std::filesystem::path &path, glm::ivec2 size_px, std::span<const std::uint8_t> rgba,
               const Metadata &metadata);

/** Writes the file atomically. \throws std::runtime_error naming \a path if it cannot be written. */
void write_text(const std::filesystem::path &path, const std::string &text);

/**
 * Reads a file of write_exr: red, green, blue and 1, rows from the bottom.
 * \throws std::runtime_error naming \a path if it cannot be read or has another size.
 */
[[nodiscard]] std::vector<glm::vec4> read_exr(const std::filesystem::path &path, glm::ivec2 size_px);
/** A picture of any size. */
struct Picture {
  glm::ivec2 size_px{0};
  /** Scene-linear red, green, blue and 1, rows from the bottom. */
  std::vector<glm::vec4> pixels;
};
/**
 * Reads the channels R, G and B of an image of any format that OpenImageIO supports. Integers are decoded by the sRGB
 * curve. \throws std::runtime_error naming \a path if it cannot be read or lacks R, G and B.
 */
[[nodiscard]] Picture read_picture(const std::filesystem::path &path);
/** The bytes of a PNG file like that of write_png, without metadata. */
[[nodiscard]] std::vector<std::byte> png_bytes(glm::ivec2 size_px, std::span<const std::uint8_t> rgba);

}  // namespace gnomon::cli
