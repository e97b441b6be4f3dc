// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>

#include <stdexcept>

namespace gnomon::cli {

/** What a command ends with: a promise to scripts. */
enum ExitStatus : int {
  STATUS_DONE = 0,
  /** One message on stderr says why. */
  STATUS_FAILED = 1,
  STATUS_USAGE = 2,
  /** The result holds NaN or infinity; nothing was written. */
  STATUS_NON_FINITE = 3,
  /** With --strict: a limit was hit, a lamp lost its shadow say. The result was written. */
  STATUS_LIMIT = 4,
};

/** Asks for something that cannot be: ends with STATUS_USAGE. */
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/** A subcommand adds itself to \a app, and leaves its status in \a status when run. */
void add_render(CLI::App &app, int &status);
void add_info(CLI::App &app, int &status);
void add_shaders(CLI::App &app, int &status);

}  // namespace gnomon::cli
