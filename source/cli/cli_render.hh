// SPDX-License-Identifier: MIT
#pragma once

#include "cli_render_options.hh"
#include "cli_work_plan.hh"

#include "gpu_device.hh"
#include "output_roles.hh"

namespace gnomon::cli {

/** An estimate for the pictures of a scene. */
struct MeasuredScene {
  std::string fingerprint;
  PictureCost cost;
};

/**
 * Imports the scene of \a options and, if \a device is not null, draws some samples of the middle frame on it.
 * \a roles: receives the files of the scene as inputs.
 * \throws std::runtime_error as `gnomon render`; output::Conflict where an output would replace an input
 */
[[nodiscard]] MeasuredScene measure_scene(const RenderOptions &options, gpu::Device *device, output::Roles &roles);

}  // namespace gnomon::cli
