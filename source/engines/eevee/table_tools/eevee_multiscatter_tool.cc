// SPDX-License-Identifier: MIT
// Writes the albedos that eevee_tables.hh declares. After a change of the lobe, run it and commit the
// result:
//   gnomon_eevee_multiscatter_tool source/engines/eevee/tables/multiscatter.bin
#include "eevee_write_table.hh"

#include "reference_multiscatter.hh"

#include "eevee_multiscatter_shared.h"

#include <cstdio>

int main(int argument_count, char **arguments)
{
  if (argument_count != 2) {
    std::fprintf(stderr, "usage: gnomon_eevee_multiscatter_tool OUTPUT.bin\n");
    return 2;
  }
  return write_table(arguments[1], gnomon::reference::MultiscatterTable(MULTISCATTER_TABLE_SIZE).texels());
}
