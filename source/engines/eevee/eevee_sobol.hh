// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>

namespace gnomon::eevee {

/**
 * The \a index-th point of an Owen-scrambled Sobol sequence in [0, 1)³. The first two components are a (0, 2)-sequence
 * in base 2: if 2^(a + b) consecutive points start at a multiple of their number, each cell of 2^-a by 2^-b contains
 * exactly one of them.
 *
 * Sequences with different \a seed are independent of each other. The values and the index are scrambled by hashes:
 * B. Burley, Practical Hash-based Owen Scrambling, JCGT 9(4), 2020. Direction numbers: S. Joe and F. Y. Kuo, 2008.
 */
[[nodiscard]] glm::vec3 sobol_point(std::uint32_t index, std::uint32_t seed);

/** Area-preserving map from \a place in [0, 1)² to the unit disk (Shirley and Chiu 1997). */
[[nodiscard]] glm::dvec2 on_disk(const glm::dvec2 &place);

}  // namespace gnomon::eevee
