// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace gnomon::cli {

/** Where and when figures were measured, for whoever reads them later. */
struct Origin {
  /** Name and version. */
  std::string program;
  /** That the program was built from, with "-dirty" where files were edited. */
  std::string commit;
  /** UTC, "2026-11-21 19:30". */
  std::string date;
  /** "2 cores, AMD EPYC". */
  std::string machine;
};

[[nodiscard]] Origin origin();

}  // namespace gnomon::cli
