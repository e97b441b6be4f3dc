// SPDX-License-Identifier: MIT
#include "scene_image.hh"

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::scene {

float decoded_srgb(float value)
{
  return value <= 0.04045F ? value / 12.92F : std::pow((value + 0.055F) / 1.055F, 2.4F);
}

namespace {

/** IEC 61966-2-1. */
float encoded_srgb(float value)
{
  return value <= 0.0031308F ? 12.92F * value : 1.055F * std::pow(value, 1.0F / 2.4F) - 0.055F;
}

/** The texels that a texel of the reduced image covers along an edge. */
struct Span {
  std::uint32_t first = 0;
  /** The share of each texel from `first` on. The sum is 1. */
  std::vector<float> shares;
};

std::vector<Span> spans_of(std::uint32_t size, std::uint32_t reduced_size)
{
  std::vector<Span> spans(reduced_size);
  const double step = double(size) / reduced_size;
  for (std::uint32_t i = 0; i < reduced_size; i++) {
    const double start = i * step;
    const double end = start + step;
    Span &span = spans[i];
    span.first = std::uint32_t(start);
    for (std::uint32_t texel = span.first; texel < size && texel < end; texel++) {
      span.shares.push_back(float((std::min(end, texel + 1.0) - std::max(start, double(texel))) / step));
    }
  }
  return spans;
}

}  // namespace

Image reduced(Image image, std::uint32_t size_max, bool is_color)
{
  const std::uint32_t longer = std::max(image.width, image.height);
  if (longer <= size_max) {
    return image;
  }
  const auto reduced_size = [&](std::uint32_t size) {
    return std::max(std::uint32_t(std::lround(double(size) * size_max / longer)), 1U);
  };
  std::array<float, 256> decoded{};
  for (std::size_t i = 0; i < decoded.size(); i++) {
    const float value = float(i) / 255.0F;
    decoded[i] = is_color ? decoded_srgb(value) : value;
  }
  const std::vector<Span> columns = spans_of(image.width, reduced_size(image.width));
  const std::vector<Span> rows = spans_of(image.height, reduced_size(image.height));
  Image result{std::move(image.name), std::uint32_t(columns.size()), std::uint32_t(rows.size()), {}};
  result.texels.reserve(4 * columns.size() * rows.size());
  for (const Span &row : rows) {
    for (const Span &column : columns) {
      std::array<float, 4> sum{};
      for (std::size_t b = 0; b < row.shares.size(); b++) {
        for (std::size_t a = 0; a < column.shares.size(); a++) {
          const float share = row.shares[b] * column.shares[a];
          const std::size_t texel = 4 * ((row.first + b) * image.width + column.first + a);
          for (std::size_t c = 0; c < 4; c++) {
            const std::uint8_t value = image.texels[texel + c];
            sum[c] += share * (c < 3 ? decoded[value] : float(value) / 255.0F);
          }
        }
      }
      for (std::size_t c = 0; c < 4; c++) {
        const float value = is_color && c < 3 ? encoded_srgb(sum[c]) : sum[c];
        result.texels.push_back(std::uint8_t(std::lround(255.0F * std::clamp(value, 0.0F, 1.0F))));
      }
    }
  }
  return result;
}

}  // namespace gnomon::scene
