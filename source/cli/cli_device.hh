// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_create_device.hh"

#include <CLI/CLI.hpp>

namespace gnomon::cli {

/** The option --backend. \a null: what the backend `null` does instead; empty: the command must draw. */
void add_backend_option(CLI::App &command, std::string &backend, std::string_view null = "");

/** A device of the backend \a name, with the cache of shaders. \throws gpu::Error */
[[nodiscard]] std::unique_ptr<gpu::Device> create_device(std::string_view name);

}  // namespace gnomon::cli
