// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <span>

namespace gnomon::measure {

/**
 * Perceived difference of two pictures that are shown alternately, in [0, 1]: the mean over the pixels of FLIP
 * (Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference Evaluator for Alternating
 * Images", 2020). The pictures are compared as displayed with the sRGB curve, at 67 pixels per degree.
 *
 * Both: scene-linear R, G, B and an ignored value. \pre both are finite and of size_px
 */
[[nodiscard]] double mean_flip(glm::ivec2 size_px, std::span<const glm::vec4> picture,
                               std::span<const glm::vec4> reference);

}  // namespace gnomon::measure
