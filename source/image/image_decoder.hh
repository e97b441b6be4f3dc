// SPDX-License-Identifier: MIT
#pragma once

#include "image_error.hh"

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace gnomon::image {

/** A file format that open_decoder() reads. */
enum class Format { None, Png, Jpeg, Webp };

/** By the first bytes of a file. */
[[nodiscard]] Format format_of(std::span<const unsigned char> file);

/**
 * One PNG, JPEG or WebP file, without animation. Texels are those that the file stores: colour profiles and gamma
 * values are ignored, and colours are not multiplied by alpha. Several decoders may run concurrently, each on one
 * thread at a time.
 */
class Decoder {
 public:
  virtual ~Decoder() = default;
  Decoder(const Decoder &) = delete;
  Decoder &operator=(const Decoder &) = delete;

  /**
   * At least 1. A header can state any size that a file of its length can store, so limit it before read_rgba8() and
   * read_rgba16().
   */
  [[nodiscard]] std::uint32_t width() const
  {
    return width_;
  }
  [[nodiscard]] std::uint32_t height() const
  {
    return height_;
  }

  /**
   * Red, green, blue and alpha of each texel, in rows from the top. Grey is the same in all colours, a missing alpha is
   * 255, and 16 bits are rounded to 8. Call this or read_rgba16(), once.
   *
   * \throws Error for a damaged file.
   */
  [[nodiscard]] virtual std::vector<std::uint8_t> read_rgba8() = 0;
  /** The same with 16 bits, of which 8-bit values v become 257 v. */
  [[nodiscard]] virtual std::vector<std::uint16_t> read_rgba16();

 protected:
  Decoder() = default;
  std::uint32_t width_ = 0;
  std::uint32_t height_ = 0;

  [[nodiscard]] std::size_t value_count() const
  {
    return std::size_t(4) * width_ * height_;
  }
};

/**
 * Reads the header. \a file must outlive the decoder. \throws Error if it is damaged, of another format, or too short
 * for its size
 */
[[nodiscard]] std::unique_ptr<Decoder> open_decoder(std::span<const unsigned char> file);

}  // namespace gnomon::image
