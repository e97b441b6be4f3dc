// SPDX-License-Identifier: MIT
#pragma once

#include "image_error.hh"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::image {

/** Whether the first bytes are those of a Radiance picture (.hdr, .pic). */
[[nodiscard]] bool is_radiance(std::span<const unsigned char> file);

/**
 * A Radiance picture in memory (Ward, "Real Pixels", Graphics Gems II, 1991): red, green and blue with one exponent, as
 * four bytes a pixel or as runs of each of the four in a row. Rows must be stored from the top and pixels from the
 * left. Runs of whole pixels, which programs wrote until 1991, are not read. Values are those that the file stores: the
 * lines EXPOSURE and COLORCORR of the header are ignored.
 */
class RadianceDecoder {
 public:
  /**
   * Reads the header. \a file must outlive the decoder. \throws Error if the header is damaged or states another order
   * or other primaries, or if the file is too short for the stated size
   */
  explicit RadianceDecoder(std::span<const unsigned char> file);

  /** At least 1. A header can state any size, so limit it before read_rgb(). */
  [[nodiscard]] std::uint32_t width() const
  {
    return width_;
  }
  [[nodiscard]] std::uint32_t height() const
  {
    return height_;
  }
  /** Red, green and blue of each pixel, in rows from the top. Call this once. \throws Error for a damaged file. */
  [[nodiscard]] std::vector<float> read_rgb();

 private:
  /** Reads a row into \a row: first all values of red, then those of green, blue and the exponent. */
  void read_row(std::span<unsigned char> row);
  [[nodiscard]] std::span<const unsigned char> take(std::size_t count);

  /** What has not been read. */
  std::span<const unsigned char> rest_;
  std::uint32_t width_ = 0;
  std::uint32_t height_ = 0;
};

}  // namespace gnomon::image
