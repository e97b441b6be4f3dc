// SPDX-License-Identifier: MIT
#pragma once

#include "image_error.hh"

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gnomon::image {

/**
 * A PNG file with 8 bits a channel.
 *
 * \param channel_count 3: red, green, blue; 4: and alpha, by which colours are not multiplied.
 * \param texels in rows from the top.
 * \param texts names of 1 to 79 ASCII characters, and their values in UTF-8; empty values are not written.
 * \pre width, height > 0, texels.size() == width * height * channel_count
 * \throws Error
 */
[[nodiscard]] std::vector<unsigned char> png_file(std::uint32_t width, std::uint32_t height, int channel_count,
                                                  std::span<const std::uint8_t> texels,
                                                  std::span<const std::pair<std::string, std::string>> texts = {});

}  // namespace gnomon::image
