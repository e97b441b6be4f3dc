// SPDX-License-Identifier: MIT
#include "scene_property.hh"

#include <fmt/format.h>

namespace gnomon::scene {

std::string range_text(const Description &description, double factor)
{
  if (description.max < float_max) {
    return fmt::format("from {:g} to {:g}", factor * description.min, factor * description.max);
  }
  return description.min <= -float_max ? "a finite number" : fmt::format("at least {:g}", factor * description.min);
}

}  // namespace gnomon::scene
