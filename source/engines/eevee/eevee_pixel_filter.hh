// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>

namespace gnomon::eevee {

/** Diameter of the pixel filter's support, pixels. Cycles and EEVEE define it as a filter width of 1.5 px. */
inline constexpr double filter_support_px = 3.0;

/** The Blackman-Harris window (Harris 1978): 1 at the centre, 0 from filter_support_px / 2 on. */
[[nodiscard]] double filter_weight(double distance_px);

/**
 * Offset of the \a index-th of \a count samples from the centre of its pixel, in [-0.5, 0.5) pixels. A single sample is
 * at the centre. Several samples form a lattice that covers the square evenly. \a count 0 selects a lattice sequence
 * for an unknown number of samples: all of its prefixes cover the square evenly. \a seed shifts the lattice or
 * sequence.
 */
[[nodiscard]] glm::vec2 film_offset_px(int index, int count, std::uint32_t seed);

/** Weights of one sample's three columns and three rows of pixels around a pixel. */
struct FilmWeights {
  glm::vec3 columns{0.0F};
  glm::vec3 rows{0.0F};
};

/**
 * Sum of the unnormalised weights of all \a count samples: the divisor of film_weights. For \a count 0, the weight of a
 * single sample at the centre, so that the weights of n samples sum to about n.
 */
[[nodiscard]] double film_weight_sum(int count, std::uint32_t seed);

/**
 * Weights of the \a index-th sample. A pixel is the filtered mean of all samples within the filter's support around its
 * centre, including samples in neighbouring pixels. With a known count, the weights of all samples sum to 1.
 * \a weight_sum: film_weight_sum of the same count and seed.
 */
[[nodiscard]] FilmWeights film_weights(int index, int count, std::uint32_t seed, double weight_sum);

/** Sum of film_weights of the \a index-th sample over its nine pixels. */
[[nodiscard]] double film_share(int index, int count, std::uint32_t seed, double weight_sum);

}  // namespace gnomon::eevee
