// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec4.hpp>

#include <span>

namespace gnomon::measure {

/**
 * How different two pictures look to an eye that flips between them, in [0, 1]: the mean over the pixels of FLIP
 * (Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, "FLIP: A Difference Evaluator for Alternating
 * Images", 2020), of what a display shows of them through the sRGB curve, at 67 pixels a degree.
 *
 * Both: scene-linear R, G, B and a value that is ignored. \pre both are finite and of size_px
 */
[[nodiscard]] double mean_flip(glm::ivec2 size_px, std::span<const glm::vec4> picture,
                               std::span<const glm::vec4> reference);

}  // namespace gnomon::measure
