// SPDX-License-Identifier: MIT
#include "measure_flip.hh"

namespace gnomon::measure {

double mean_flip(glm::ivec2, std::span<const glm::vec4>, std::span<const glm::vec4>)
{
  return 0.0;
}

}  // namespace gnomon::measure
