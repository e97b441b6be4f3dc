// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device_info.hh"
#include "scene.hh"

#include <glm/vec2.hpp>

#include <string>
#include <vector>

namespace gnomon::gpu {
class Device;
}

/** The benchmark `gnomon bench frames`: times of the frames of a host, one by one. */
namespace gnomon::measure {

struct FrameTimesSettings {
  glm::ivec2 size_px{640, 360};
  /** Measured frames of each kind, after some that warm up. At least 1. */
  int frame_count = 300;
  /** Time that draws with a budget may take, seconds. \see eevee::SceneRenderer::draw_within */
  double budget_seconds = 0.033;
};

/** Draws within the budget, with settings of 16 samples. Wall times until the device is done, seconds. */
struct BudgetTimes {
  /** The camera is moved, and a picture is drawn within the budget. */
  std::vector<double> moved_camera;
  /** A still picture is refined within the budget: without the first frame after the camera has moved. */
  std::vector<double> refined;
  /** The counters of frame_count calls after the picture was complete, without a target. */
  gpu::Counters still;
  /** RMS of red, green and blue of that picture, and of their differences to a picture drawn without a budget. */
  double picture_rms = 0.0;
  double difference_rms = 0.0;
};

/** Wall times of whole frames, until the device is done, seconds. */
struct FrameTimes {
  /** A clear and a wait, before each frame of moved_lamp: the least that the machine adds to a frame. */
  std::vector<double> control;
  /** One lamp is moved, and a whole sample is drawn. Empty: the scene has no lamp. */
  std::vector<double> moved_lamp;
  /**
   * Multiplications that take about as long as a frame of moved_lamp, on all cores, after every fifth frame: the least
   * that the machine adds to work of that length. The numbers are in arrays of 16 KiB for each core, of 512 KiB, and of
   * 16 MiB, which caches do not keep.
   */
  std::vector<double> small_arithmetic;
  std::vector<double> large_arithmetic;
  std::vector<double> uncached_arithmetic;
  /** With the default settings of views that move. */
  BudgetTimes moving;
  /** With the shadows of `gnomon render`. \see eevee::offline_settings */
  BudgetTimes offline;
};

/** The value that \a share of the times do not exceed. \a share in [0, 1] \pre \a seconds is not empty */
[[nodiscard]] double percentile(std::vector<double> seconds, double share);

/** Measures frames of a copy of \a scene, seen by its first camera. \pre the scene has a camera */
[[nodiscard]] FrameTimes measure_frame_times(gpu::Device &device, scene::Scene scene,
                                             const FrameTimesSettings &settings);

}  // namespace gnomon::measure
