// SPDX-License-Identifier: MIT
#pragma once

#include "cli.hh"
#include "cli_render_options.hh"
#include "cli_render_report.hh"
#include "cli_stop.hh"
#include "cli_time.hh"
#include "cli_work_plan.hh"

#include "gpu_device.hh"
#include "output_roles.hh"
#include "scene.hh"

#include <future>
#include <string>

/** The pictures of one scene. */
namespace gnomon::cli {

struct ImportedScene {
  scene::Scene scene;
  /** \see PlannedScene::fingerprint. Empty: it is not compared. */
  std::string fingerprint{};
  double seconds = 0.0;
};

/** Imports on another thread. \a options and \a stops must outlive it. */
[[nodiscard]] std::future<ImportedScene> start_import(const RenderOptions &options, const StopRequests &stops);

/**
 * Renders the pictures of one scene. The result has the times of the import and of the device.
 * \throws std::runtime_error if an input is at fault; output::Conflict where an output would replace an input
 */
[[nodiscard]] Status render_scene(RenderOptions options, gpu::Device &device, ImportedScene &imported,
                                  output::Roles &roles, const StopRequests &stops, Clock::time_point start,
                                  RenderResult &result);

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
