// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <cstdint>
#include <memory>
#include <span>
#include <string>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * A PNG or JPEG file in memory. 16-bit values are rounded to 8, grey becomes three equal colours, and what has no alpha
 * is opaque. Profiles and gammas in the file are not used, as glTF asks.
 */
class ImageDecoder {
 public:
  /**
   * Reads the head of the file. Keeps \a bytes.
   *
   * \throws Fault that names \a what, for a file that is cut off, of another format, or of more than
   * \a texel_count_max texels.
   */
  ImageDecoder(std::span<const unsigned char> bytes, std::string what, std::uint64_t texel_count_max);
  ImageDecoder(ImageDecoder &&) noexcept;
  ~ImageDecoder();

  [[nodiscard]] std::uint64_t texel_count() const;
  /** The texels, without a name. Several decoders may read at once. \throws Fault for a file that is damaged. */
  [[nodiscard]] scene::Image read();

 private:
  struct Input;
  std::unique_ptr<Input> input_;
};

}  // namespace gnomon::gltf
