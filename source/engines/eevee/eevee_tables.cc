// SPDX-License-Identifier: MIT
#include "eevee_tables.hh"

#include "eevee_table_files.hh"

#include <cstring>

namespace gnomon::eevee {

/** The floats of an embedded file. They are copied because its bytes need not be aligned. */
static std::vector<float> floats_of(std::string_view path)
{
  const std::string_view bytes = table_files::file(path).value();
  std::vector<float> floats(bytes.size() / sizeof(float));
  std::memcpy(floats.data(), bytes.data(), bytes.size());
  return floats;
}

std::span<const float> ltc_table()
{
  static const std::vector<float> table = floats_of("ltc.bin");
  return table;
}

std::span<const float> multiscatter_table()
{
  static const std::vector<float> table = floats_of("multiscatter.bin");
  return table;
}

}  // namespace gnomon::eevee
