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

/** Version and commit, of which a plan's parts must have the same: "gnomon 3.0, 1a2b3c4". */
[[nodiscard]] std::string program_name();

}  // namespace gnomon::cli
