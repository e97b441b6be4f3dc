// SPDX-License-Identifier: MIT
#include "measure_stability.hh"

namespace gnomon::measure {

std::vector<StabilityCase> image_stability_cases(gpu::Device & /*device*/)
{
  return {};
}

}  // namespace gnomon::measure
