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
 * Where in each pixel the \a index-th of \a count samples lies, from its centre, in [-0.5, 0.5) pixels. One sample is
 * at the centre. More are a lattice that fills the square evenly; another \a seed shifts it.
 */
[[nodiscard]] glm::vec2 film_offset_px(int index, int count, std::uint32_t seed);

/** Weights of one sample's three columns and three rows of pixels around a pixel. */
struct FilmWeights {
  glm::vec3 columns{0.0F};
  glm::vec3 rows{0.0F};
};

/** What the weights of all \a count samples amount to, before they are divided by it. */
[[nodiscard]] double film_weight_sum(int count, std::uint32_t seed);

/**
 * \see film_offset_px. A pixel is the filter's mean of all samples that lie within its support, its neighbours' too:
 * the weights of all samples sum to 1. \a weight_sum: film_weight_sum of the same count and seed.
 */
[[nodiscard]] FilmWeights film_weights(int index, int count, std::uint32_t seed, double weight_sum);

/** The sum of one sample's weights. Those of all samples sum to 1. */
[[nodiscard]] double film_share(int index, int count, std::uint32_t seed, double weight_sum);

}  // namespace gnomon::eevee
