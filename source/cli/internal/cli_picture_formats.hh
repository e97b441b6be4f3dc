// SPDX-License-Identifier: MIT
#pragma once

#include "cli_picture.hh"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

/** The parts of read_picture(), which adds the file's name to what they throw. */
namespace gnomon::cli {

/** So that a damaged header does not ask for all memory. \throws std::runtime_error for too few and too many pixels. */
inline void check_edges(std::int64_t width, std::int64_t height)
{
  constexpr int edge_max = 32768;
  if (width < 1 || height < 1 || width > edge_max || height > edge_max) {
    throw std::runtime_error(fmt::format("has {}x{} pixels: an edge may have 1 to {}", width, height, edge_max));
  }
  constexpr std::int64_t pixel_count_max = std::int64_t(1) << 28U;
  if (width * height > pixel_count_max) {
    throw std::runtime_error(fmt::format("has {}x{} pixels, which are more than {}", width, height, pixel_count_max));
  }
}

/** The inverse of the sRGB curve. */
[[nodiscard]] inline float linear_of_srgb(float encoded)
{
  return encoded <= 0.04045F ? encoded / 12.92F : std::pow((encoded + 0.055F) / 1.055F, 2.4F);
}

/** The warning for a file that states other primaries than those of Rec. 709. */
inline constexpr const char *primaries_warning =
    "states other primaries than Rec. 709, and its colours are taken as Rec. 709";

/**
 * The display window of an EXR file: pixels outside of the data window are black. Nothing if \a path is not an EXR
 * file. \see read_picture
 */
[[nodiscard]] std::optional<Picture> read_exr_picture(const std::filesystem::path &path, const std::string &layer);

}  // namespace gnomon::cli
