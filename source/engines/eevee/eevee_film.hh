// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>

#include <cstdint>

namespace gnomon::eevee {

/** Width of the pixel filter where it has fallen to nothing, pixels: Blackman-Harris of 1.5 px in Cycles' and EEVEE's terms. */
inline constexpr double FILTER_SUPPORT_PX = 3.0;

/** Share of the filter's weight at or left of \a x_px from its centre; 0 to 1 over ± half the support. Closed form. */
[[nodiscard]] double filter_cdf(double x_px);

/** The offset below which \a share of the weight lies: samples there, all of weight 1, amount to the filter. */
[[nodiscard]] double filter_inverse_cdf(double share);

/**
 * Where in (and around) the pixel the \a index-th of \a count samples lies, from its centre, pixels.
 * One sample is at the centre. More are spread evenly over the filter's weight; another \a seed shifts them.
 */
[[nodiscard]] glm::vec2 film_offset_px(int index, int count, std::uint32_t seed);

}  // namespace gnomon::eevee
