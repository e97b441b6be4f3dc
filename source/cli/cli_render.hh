// SPDX-License-Identifier: MIT
#pragma once

#include "cli.hh"
#include "cli_render_options.hh"
#include "cli_render_report.hh"

namespace gnomon::cli {

/**
 * Renders all scenes of \a options. \a result: receives that of the last scene.
 * \throws UsageError; std::runtime_error as `gnomon render`
 */
[[nodiscard]] Status render(RenderOptions options, RenderResult &result);

}  // namespace gnomon::cli
