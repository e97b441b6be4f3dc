// SPDX-License-Identifier: MIT
#pragma once

#include "image_decoder.hh"

/** Internal to source/image. */
namespace gnomon::image {

[[nodiscard]] std::unique_ptr<Decoder> open_png(std::span<const unsigned char> file);
[[nodiscard]] std::unique_ptr<Decoder> open_jpeg(std::span<const unsigned char> file);
[[nodiscard]] std::unique_ptr<Decoder> open_webp(std::span<const unsigned char> file);

}  // namespace gnomon::image
