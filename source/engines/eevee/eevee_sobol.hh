// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec3.hpp>

#include <cstdint>

namespace gnomon::eevee {

/**
 * The \a index-th point of an Owen-scrambled Sobol sequence in [0, 1)³. The first two components are a (0, 2)-sequence
 * in base 2: of any 2^(a + b) points that start at a multiple of it, one is in each cell of 2^-a by 2^-b.
 *
 * Sequences of different \a seed are independent of each other. Scrambling by hashes, and of the index too: B. Burley,
 * Practical Hash-based Owen Scrambling, JCGT 9(4), 2020. Direction numbers: S. Joe and F. Y. Kuo, 2008.
 */
[[nodiscard]] glm::vec3 sobol_point(std::uint32_t index, std::uint32_t seed);

/** Mixes the bits of \a value, so that neighbours have unrelated results. */
[[nodiscard]] std::uint32_t mixed_bits(std::uint32_t value);

}  // namespace gnomon::eevee
