// SPDX-License-Identifier: MIT
#pragma once

#include "output_text.hh"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>

namespace gnomon::cli {

/** Exit status of a command. Scripts rely on these values. */
enum class Status : int {
  Done = 0,
  /** One message on stderr gives the reason. */
  Failed = 1,
  Usage = 2,
  /** The result contains NaN or infinity; nothing was written. */
  NonFinite = 3,
  /** With --strict: a limit was reached, for example a lamp has no shadow. The result was written. */
  Limit = 4,
  /** Failed for a reason that another attempt or another machine may not have: memory, the device, or the disk. */
  Transient = 5,
  /** Ended early by SIGTERM or --stop-after. */
  Stopped = 6,
};

/** An invalid request on the command line: ends with Status::Usage. */
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/**
 * Prints to stderr as far as it can be written: a warning that is lost must not end the work. Names have no characters
 * that terminals obey, and lines after the first are indented, so that no name looks like a message.
 */
template <typename... Arguments>
void print_message(fmt::format_string<Arguments...> format, Arguments &&...arguments)
{
  const std::string text = fmt::format(format, std::forward<Arguments>(arguments)...);
  static_cast<void>(std::fputs(output::printable_text(text, "  ").c_str(), stderr));
}

/** A check of an option that accepts numbers from \a min to \a max. CLI::Range alone also accepts "nan". */
[[nodiscard]] inline CLI::Validator number_range(double min, double max)
{
  return CLI::Validator(CLI::Range(min, max)) & CLI::Validator(
                                                    [](const std::string &text) {
                                                      double value = 0.0;
                                                      return CLI::detail::lexical_cast(text, value) && std::isnan(value)
                                                                 ? "is not a number: " + text
                                                                 : std::string();
                                                    },
                                                    "");
}

/** Each function adds a subcommand to \a app. When the subcommand runs, it sets \a status. */
void add_render(CLI::App &app, Status &status);
void add_info(CLI::App &app, Status &status);
void add_compare(CLI::App &app, Status &status);
void add_merge(CLI::App &app, Status &status);
void add_plan(CLI::App &app, Status &status);
void add_report(CLI::App &app, Status &status);
void add_stability(CLI::App &app, Status &status);
void add_shaders(CLI::App &app, Status &status);
void add_bench(CLI::App &app, Status &status);
/** Its status is Done unless it throws. */
void add_view(CLI::App &app);

}  // namespace gnomon::cli
