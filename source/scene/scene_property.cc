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
  const bool is_mirrored = description.least > 0.0;
  return fmt::format("from {:g} to {:g}{}", factor * (is_mirrored ? description.least : description.min),
                     factor * description.max, is_mirrored ? ", or the negative of such a number" : "");
}

std::string number_text(const Description &description, double value)
{
  return fmt::format("{:g}", value * shown_unit(description).factor);
}

std::string range_fault(const Description &description, double value)
{
  return fmt::format("{} {:g} is not {}", description.name, value, range_text(description));
}

}  // namespace gnomon::scene
