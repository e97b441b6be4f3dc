// SPDX-License-Identifier: MIT
#pragma once

#include "image_decoder.hh"
#include "internal/gltf_file.hh"
#include "scene.hh"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** The bytes of an image file. Moving it keeps them where they are; it must not be copied. */
struct EncodedImage {
  /** Empty if the bytes are in one of the glTF file's buffers. */
  std::vector<unsigned char> storage;
  std::span<const unsigned char> bytes;
};

/** \throws Fault that names \a what, if the bytes of \a image are not there. */
[[nodiscard]] EncodedImage encoded_image(const File &file, const Model::Image &image, const std::string &what);

/**
 * A PNG, JPEG or WebP file in memory. 16-bit values are rounded to 8 bits, grey is expanded to RGB, and a missing alpha
 * is opaque. Colour profiles and gamma values are ignored, as glTF requires.
 */
class ImageDecoder {
 public:
  /**
   * Reads the header of the file. \a bytes must outlive the decoder.
   *
   * \throws Fault that names \a what, if the file is truncated, of another format, or has more than \a texel_count_max
   * texels.
   */
  ImageDecoder(std::span<const unsigned char> bytes, std::string what, std::uint64_t texel_count_max);

  [[nodiscard]] std::uint64_t texel_count() const
  {
    return std::uint64_t(file_->width()) * file_->height();
  }
  /** Decodes the image, without a name. Several decoders may run concurrently. \throws Fault for a damaged file. */
  [[nodiscard]] scene::Image read();

 private:
  std::string what_;
  std::unique_ptr<image::Decoder> file_;
};

}  // namespace gnomon::gltf
