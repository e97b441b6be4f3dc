// SPDX-License-Identifier: MIT
#include "eevee_tables.hh"

namespace gnomon::eevee {

std::span<const float> ltc_table()
{
  static constexpr float values[] = {
#include "tables/ltc.inc"
  };
  return values;
}

std::span<const float> multiscatter_table()
{
  static constexpr float values[] = {
#include "tables/multiscatter.inc"
  };
  return values;
}

}  // namespace gnomon::eevee
