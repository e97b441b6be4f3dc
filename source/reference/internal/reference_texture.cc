// SPDX-License-Identifier: MIT
#include "internal/reference_texture.hh"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::reference {

namespace {

/** Table of the sRGB decoding (IEC 61966-2-1) for bytes. */
std::array<double, 256> make_decoded_srgb()
{
  std::array<double, 256> decoded{};
  for (std::size_t i = 0; i < decoded.size(); i++) {
    const double x = double(i) / 255.0;
    decoded[i] = x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4);
  }
  return decoded;
}

/** Index of the texel at \a place, an integer counted from the first of \a size texels. */
std::uint32_t wrapped(double place, std::uint32_t size, scene::TextureWrap wrap)
{
  const double count = size;
  switch (wrap) {
    case scene::TextureWrap::ClampToEdge: place = std::clamp(place, 0.0, count - 1.0); break;
    case scene::TextureWrap::Repeat: place -= count * std::floor(place / count); break;
    case scene::TextureWrap::MirroredRepeat:
      place -= 2.0 * count * std::floor(place / (2.0 * count));
      place = place < count ? place : 2.0 * count - 1.0 - place;
      break;
  }
  // For large values, `place` may not be an exact integer in this range.
  return std::uint32_t(std::clamp(place, 0.0, count - 1.0));
}

}  // namespace

glm::dvec4 texture_at(const scene::Image &image, const scene::Texture &texture, const glm::dvec2 &uv)
{
  static const std::array<double, 256> decoded_srgb = make_decoded_srgb();
  const auto texel = [&](double column, double row) {
    const std::size_t x = wrapped(column, image.width, texture.wrap_u);
    const std::size_t y = wrapped(row, image.height, texture.wrap_v);
    const std::uint8_t *rgba = &image.texels[4 * (y * image.width + x)];
    return glm::dvec4(decoded_srgb[rgba[0]], decoded_srgb[rgba[1]], decoded_srgb[rgba[2]], rgba[3] / 255.0);
  };
  const glm::dvec2 at = uv * glm::dvec2(image.width, image.height);
  if (texture.magnified == scene::TextureFilter::Nearest) {
    return texel(std::floor(at.x), std::floor(at.y));
  }
  const glm::dvec2 low = glm::floor(at - 0.5);
  const glm::dvec2 share = at - 0.5 - low;
  return glm::mix(glm::mix(texel(low.x, low.y), texel(low.x + 1.0, low.y), share.x),
                  glm::mix(texel(low.x, low.y + 1.0), texel(low.x + 1.0, low.y + 1.0), share.x), share.y);
}

}  // namespace gnomon::reference
