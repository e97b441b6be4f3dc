// SPDX-License-Identifier: MIT
#pragma once

#include "cli_render_options.hh"

#include "eevee_inspection.hh"
#include "gpu_device.hh"

#include <nlohmann/json_fwd.hpp>

namespace gnomon::cli {

/** Measurements for the printed summary and for --json. */
struct RenderResult {
  std::string device;
  /** The number of samples of the last picture. */
  int samples_drawn = 0;
  double import_seconds = 0.0;
  double device_seconds = 0.0;
  double sync_seconds = 0.0;
  std::vector<double> frame_seconds;
  std::vector<std::vector<eevee::StepTime>> frame_steps;
  std::vector<eevee::ShadowCounters> frame_shadows;
  /** Number of frames that --resume skipped. */
  int skipped_frame_count = 0;
  /** The time of the layers of --aov. */
  double layer_seconds = 0.0;
  double output_seconds = 0.0;
  double total_seconds = 0.0;
  std::size_t non_finite_count = 0;
  gpu::Counters counters;
  /** Device memory of all resources at the end. */
  std::size_t memory_bytes = 0;
  eevee::Report report;
};

/**
 * The content of --json. \a settings: those of the picture; \a chooser: null without --max-error and --max-time
 */
[[nodiscard]] nlohmann::json to_json(const RenderOptions &options, const eevee::Settings &settings,
                                     const scene::Scene &scene, const scene::Camera &camera, const RenderResult &result,
                                     const Chooser *chooser);

/** Prints times, the parts that were made, and the path of the picture. */
void print_summary(const RenderOptions &options, const RenderResult &result);

}  // namespace gnomon::cli
