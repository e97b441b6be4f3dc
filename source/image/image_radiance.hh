// SPDX-License-Identifier: MIT
#pragma once

#include "image_error.hh"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::image {

/** Whether \a primaries, x and y of red, green, blue and white, are those of Rec. 709, in files that may round them. */
[[nodiscard]] bool is_rec709(const std::array<double, 8> &primaries);

/** Whether the first bytes are those of a Radiance picture (.hdr, .pic). */
[[nodiscard]] bool is_radiance(std::span<const unsigned char> file);

/**
 * A Radiance picture in memory (Ward, "Real Pixels", Graphics Gems II, 1991): three values with one exponent, as four
 * bytes a pixel, as runs of each of the four in a row, or as runs of whole pixels, which programs wrote until 1991.
 * Rows or columns may be stored from each side. Values are radiances: those of the file divided by all EXPOSURE and
 * COLORCORR of the header, and converted from CIE XYZ to the primaries of Rec. 709 where the format is 32-bit_rle_xyze.
 */
class RadianceDecoder {
 public:
  /**
   * Reads the header. \a file must outlive the decoder. \throws Error if the header is damaged or states another
   * format, or if the file is too short for the stated size
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
  /** Whether its red, green and blue have stated PRIMARIES that are not those of Rec. 709. They are not converted. */
  [[nodiscard]] bool has_other_primaries() const
  {
    return has_other_primaries_ && !is_xyz_;
  }
  /** Red, green and blue of each pixel, in rows from the top. Call this once. \throws Error for a damaged file. */
  [[nodiscard]] std::vector<float> read_rgb();

 private:
  /** Reads a stored row or column into \a line: first all values of the first channel, then those of the others. */
  void read_line(std::span<unsigned char> line);
  void read_channel_runs(std::span<unsigned char> line);
  void read_pixel_runs(std::span<const unsigned char> first_pixel, std::span<unsigned char> line);
  [[nodiscard]] std::span<const unsigned char> take(std::size_t count);

  /** The bytes that have not been read. */
  std::span<const unsigned char> rest_;
  std::uint32_t width_ = 0;
  std::uint32_t height_ = 0;
  /** Columns are stored instead of rows. */
  bool has_columns_ = false;
  bool is_from_right_ = false;
  bool is_from_bottom_ = false;
  bool is_xyz_ = false;
  bool has_other_primaries_ = false;
  /** The factors of the stored values. */
  std::array<double, 3> exposure_{1.0, 1.0, 1.0};
};

}  // namespace gnomon::image
