// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>

#include <stdexcept>

namespace gnomon::cli {

/** What a command ends with: a promise to scripts. */
enum class Status : int {
  Done = 0,
  /** One message on stderr says why. */
  Failed = 1,
  Usage = 2,
  /** The result holds NaN or infinity; nothing was written. */
  NonFinite = 3,
  /** With --strict: a limit was hit, a lamp lost its shadow say. The result was written. */
  Limit = 4,
};

/** Asks for something that cannot be: ends with Status::Usage. */
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/** A subcommand adds itself to \a app, and leaves its status in \a status when run. */
void add_render(CLI::App &app, Status &status);
void add_info(CLI::App &app, Status &status);
void add_compare(CLI::App &app, Status &status);
void add_report(CLI::App &app, Status &status);
void add_stability(CLI::App &app, Status &status);
void add_shaders(CLI::App &app, Status &status);
/** Its status is Done where it does not throw. */
void add_bench(CLI::App &app);

}  // namespace gnomon::cli
