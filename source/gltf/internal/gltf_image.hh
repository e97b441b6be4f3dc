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
   * Reads the header of the file. \a bytes must outlive the decoder. \a size_max: the image will be reduced to edges of
   * so many texels (\see ImportOptions::texture_size_max).
   *
   * \throws Fault that names \a what, if the file is truncated, of another format, or larger than ImportOptions say.
   */
  ImageDecoder(std::span<const unsigned char> bytes, std::string what, std::uint32_t size_max = 0);

  [[nodiscard]] std::uint64_t texel_count() const
  {
    return std::uint64_t(file_->width()) * file_->height();
  }
  /** The same after the reduction. */
  [[nodiscard]] std::uint64_t kept_texel_count() const
  {
    return kept_texel_count_;
  }
  /** "WIDTHxHEIGHT", before the reduction. */
  [[nodiscard]] std::string size_text() const
  {
    return std::to_string(file_->width()) + 'x' + std::to_string(file_->height());
  }
  [[nodiscard]] const std::string &what() const
  {
    return what_;
  }
  /** Decodes the image, without a name. Several decoders may run concurrently. \throws Fault for a damaged file. */
  [[nodiscard]] scene::Image read();

 private:
  std::string what_;
  std::uint64_t kept_texel_count_ = 0;
  std::unique_ptr<image::Decoder> file_;
};

}  // namespace gnomon::gltf
