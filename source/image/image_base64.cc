// SPDX-License-Identifier: MIT
#include "image_base64.hh"

#include <algorithm>
#include <cstdint>
#include <string_view>

namespace gnomon::image {

std::string base64(std::span<const unsigned char> bytes)
{
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; k++) {
      group = group << 8U | (k < count ? bytes[i + k] : 0U);
    }
    for (std::size_t k = 0; k < 4; k++) {
      text += k > count ? '=' : digits[group >> (18 - 6 * k) & 63U];
    }
  }
  return text;
}

}  // namespace gnomon::image
