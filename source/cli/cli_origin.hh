// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace gnomon::cli {

/** Program, machine and time of a measurement. */
struct Origin {
  /** Name and version. */
  std::string program;
  /** Commit of the program, with "-dirty" if files were edited. */
  std::string commit;
  /** UTC, for example "2026-11-21 19:30". */
  std::string date;
  /** For example "2 cores, AMD EPYC". */
  std::string machine;
};

[[nodiscard]] Origin origin();

}  // namespace gnomon::cli
