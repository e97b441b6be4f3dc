// SPDX-License-Identifier: MIT
// The subcommands of `gnomon shaders`.
#pragma once

#include "cli.hh"

namespace gnomon::cli {

void add_shaders_check(CLI::App &shaders, Status &status);
void add_shaders_reflect(CLI::App &shaders, Status &status);
void add_shaders_layout(CLI::App &shaders, Status &status);

}  // namespace gnomon::cli
