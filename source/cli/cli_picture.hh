// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

/** Files of pictures. Functions that write one replace an old file as a whole, or leave it. */
namespace gnomon::cli {

/** Names and values for a picture's header. */
using Metadata = std::vector<std::pair<std::string, std::string>>;

/**
 * Writes RGB as 32-bit floats. Rows from the bottom, four floats for each pixel; the fourth is dropped.
 * \throws std::runtime_error naming \a path if it cannot be written; so do the next two.
 */
void write_exr(const std::filesystem::path &path, glm::ivec2 size_px, std::span<const float> rgba,
               const Metadata &metadata);
/** Writes RGB with 8 bits. Rows from the bottom, four bytes for each pixel; the fourth is dropped. */
void write_png(const std::filesystem::path &path, glm::ivec2 size_px, std::span<const std::uint8_t> rgba,
               const Metadata &metadata);
/** The bytes of a PNG file like that of write_png, without metadata. */
[[nodiscard]] std::vector<std::byte> png_bytes(glm::ivec2 size_px, std::span<const std::uint8_t> rgba);

/** A picture of any size. */
struct Picture {
  glm::ivec2 size_px{0};
  /** Scene-linear red, green, blue and 1, rows from the bottom. */
  std::vector<glm::vec4> pixels;
};

/**
 * Reads R, G and B. The format is that of the first bytes: EXR, PNG or JPEG, or another one that OpenImageIO reads,
 * such as Radiance HDR. Integer values are decoded by the sRGB curve. \throws std::runtime_error naming \a path if it
 * cannot be read, is cut off, or lacks R, G or B.
 */
[[nodiscard]] Picture read_picture(const std::filesystem::path &path);
/** The same for a picture whose size is known. \throws std::runtime_error also for another size. */
[[nodiscard]] std::vector<glm::vec4> read_exr(const std::filesystem::path &path, glm::ivec2 size_px);

}  // namespace gnomon::cli
