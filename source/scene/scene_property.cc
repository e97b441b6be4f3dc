// SPDX-License-Identifier: MIT
#include "scene_property.hh"

#include <fmt/format.h>

#include <cmath>

namespace gnomon::scene {

ShownLimits shown_limits(const Description &description, bool is_whole)
{
  const double factor = shown_unit(description).factor;
  const ShownLimits limits{factor * description.min, factor * description.max};
  return is_whole ? ShownLimits{std::ceil(limits.min), std::floor(limits.max)} : limits;
}

std::string range_text(const Description &description, double factor)
{
  if (description.max < float_max) {
    return fmt::format("from {:g} to {:g}", factor * description.min, factor * description.max);
  }
  if (description.least > 0.0) {
    return fmt::format("at least {0:g} or at most -{0:g}", factor * description.least);
  }
  return description.min <= -float_max ? "a finite number" : fmt::format("at least {:g}", factor * description.min);
}

std::string range_fault(const Description &description, double value)
{
  return fmt::format("{} {:g} is not {}", description.name, value, range_text(description));
}

}  // namespace gnomon::scene
