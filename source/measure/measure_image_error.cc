// SPDX-License-Identifier: MIT
#include "measure_image_error.hh"

#include "measure_flip.hh"

#include "draw_view_transform_shared.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace gnomon::measure {

ImageError image_error(glm::ivec2 size_px, std::span<const glm::vec4> picture, std::span<const glm::vec4> reference)
{
  const std::size_t count = std::size_t(std::max(size_px.x, 0)) * std::size_t(std::max(size_px.y, 0));
  if (count == 0 || picture.size() != count || reference.size() != count) {
    throw std::invalid_argument(fmt::format("image error: pictures of {} and {} pixels are not of {}x{}",
                                            picture.size(), reference.size(), size_px.x, size_px.y));
  }
  ImageError error;
  double square = 0.0;
  double relative = 0.0;
  std::vector<float> largest(count);
  for (std::size_t i = 0; i < count; i++) {
    for (int c = 0; c < 3; c++) {
      error.non_finite_count += std::isfinite(picture[i][c]) && std::isfinite(reference[i][c]) ? 0 : 1;
      const double expected = double(reference[i][c]);
      const double off = double(picture[i][c]) - expected;
      square += off * off;
      relative += off * off / (expected * expected + relative_mse_floor);
      largest[i] = std::max(largest[i], float(std::abs(off)));
    }
  }
  if (error.non_finite_count > 0) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    error.rmse = error.relative_mse = error.p99 = error.flip = nan;
    return error;
  }
  error.rmse = std::sqrt(square / double(3 * count));
  error.relative_mse = relative / double(3 * count);
  const auto at = largest.begin() + std::ptrdiff_t(std::ceil(0.99 * double(count))) - 1;
  std::ranges::nth_element(largest, at);
  error.p99 = double(*at);
  error.flip = mean_flip(size_px, picture, reference);
  return error;
}

std::vector<glm::vec4> difference(std::span<const glm::vec4> picture, std::span<const glm::vec4> reference, float scale)
{
  std::vector<glm::vec4> pixels(picture.size());
  std::ranges::transform(picture, reference, pixels.begin(),
                         [scale](const glm::vec4 &a, const glm::vec4 &b) { return scale * glm::abs(a - b); });
  return pixels;
}

std::vector<std::uint8_t> display_bytes(std::span<const glm::vec4> picture)
{
  std::vector<std::uint8_t> bytes;
  bytes.reserve(4 * picture.size());
  for (const glm::vec4 &pixel : picture) {
    const glm::vec3 shown = shared::view_transformed(glm::vec3(pixel), VIEW_TRANSFORM_STANDARD);
    for (int c = 0; c < 3; c++) {
      bytes.push_back(std::uint8_t(std::lround(255.0F * shown[c])));
    }
    bytes.push_back(255);
  }
  return bytes;
}

}  // namespace gnomon::measure
