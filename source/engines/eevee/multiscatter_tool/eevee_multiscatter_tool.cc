// SPDX-License-Identifier: MIT
// Writes the albedos that eevee_tables.hh declares. After a change of the lobe, run it and commit the
// result:
//   gnomon_eevee_multiscatter_tool source/engines/eevee/tables/multiscatter.inc
#include "reference_multiscatter.hh"

#include "eevee_multiscatter_shared.h"

#include <cstdio>

int main(int argument_count, char **arguments)
{
  std::FILE *file = argument_count == 2 ? std::fopen(arguments[1], "w") : nullptr;
  if (!file) {
    std::fprintf(stderr, "usage: gnomon_eevee_multiscatter_tool OUTPUT.inc (a file that can be written)\n");
    return 2;
  }
  const gnomon::reference::MultiscatterTable table(MULTISCATTER_TABLE_SIZE);
  for (const glm::dvec4 &texel : table.texels()) {
    std::fprintf(file, "%.6eF,%.6eF,%.6eF,%.6eF,\n", texel.x, texel.y, texel.z, texel.w);
  }
  return std::fclose(file) == 0 ? 0 : 1;
}
