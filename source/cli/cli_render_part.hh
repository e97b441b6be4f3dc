// SPDX-License-Identifier: MIT
#pragma once

#include "cli.hh"
#include "cli_render_options.hh"

namespace gnomon::cli {

/**
 * Renders a part of a plan (--part), and prints a line of JSON about it. \a command: with the options of the command
 * line. \throws UsageError if it has options that only the plan may have, or if the plan has no such part
 */
[[nodiscard]] Status render_part(const RenderOptions &given, const CLI::App &command);

}  // namespace gnomon::cli
