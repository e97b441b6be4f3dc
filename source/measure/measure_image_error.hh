// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace gnomon::measure {

/** Added to the square of the reference in ImageError::relative_mse, so that black pixels count. */
inline constexpr double relative_mse_floor = 1e-2;

/** How a scene-linear picture differs from its reference, over R, G and B. */
struct ImageError {
  /** Number of NaN or infinite values in the picture and the reference. If it is not 0, the other members are NaN. */
  std::size_t non_finite_count = 0;
  double rmse = 0.0;
  /** Mean of (a - b)² / (b² + relative_mse_floor), b the reference's value. */
  double relative_mse = 0.0;
  /** 99th percentile over the pixels of the largest difference of a channel. */
  double p99 = 0.0;
  /** \see mean_flip */
  double flip = 0.0;
};

/**
 * Both: R, G, B and an ignored value, rows from the bottom.
 * \throws std::invalid_argument if a picture is not of \a size_px.
 */
[[nodiscard]] ImageError image_error(glm::ivec2 size_px, std::span<const glm::vec4> picture,
                                     std::span<const glm::vec4> reference);

/** Absolute difference of each value, times \a scale. */
[[nodiscard]] std::vector<glm::vec4> difference(std::span<const glm::vec4> picture,
                                                std::span<const glm::vec4> reference, float scale);

/** Display values with the sRGB curve, four bytes for each pixel, rows in the order of \a picture. */
[[nodiscard]] std::vector<std::uint8_t> display_bytes(std::span<const glm::vec4> picture);

}  // namespace gnomon::measure
