// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_create_device.hh"
#include "measure_error_time.hh"

#include <atomic>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace gnomon::view {

/**
 * A measurement of error against time on a separate thread with its own device, so that the window
 * stays responsive. The thread has the lowest priority. Threads: call all functions on the window's thread.
 */
class ErrorMeasurement {
 public:
  /**
   * Start the measurement on a device of \a backend. \see measure::measure_error_time \throws std::system_error if the
   * thread cannot be created
   */
  ErrorMeasurement(scene::Scene scene, const scene::PlacedCamera &camera, glm::ivec2 size_px,
                   const eevee::Settings &settings, gpu::Backend backend);
  ErrorMeasurement(const ErrorMeasurement &) = delete;
  ErrorMeasurement &operator=(const ErrorMeasurement &) = delete;
  /** Cancel, and wait until the measurement has ended (\see cancel). */
  ~ErrorMeasurement();

  /** Progress in [0, 1]. */
  [[nodiscard]] float progress() const
  {
    return progress_;
  }
  /** The points measured so far. */
  [[nodiscard]] std::vector<measure::TimedError> points() const;
  /** Whether the measurement has ended, so that finish does not wait. */
  [[nodiscard]] bool is_done() const
  {
    return is_done_;
  }
  /**
   * Request the end. The thread ends within one sample or one traced pixel, but not while it compiles shaders or builds
   * the tree of triangles.
   */
  void cancel()
  {
    is_cancelled_ = true;
  }
  [[nodiscard]] bool is_cancelled() const
  {
    return is_cancelled_;
  }
  /**
   * Wait for the end. \return the parts of the scene that the ray tracer leaves out, \see reference::untraced_parts
   * \pre not called before
   * \throws as measure::measure_error_time, and gpu::Error if the device cannot be created
   */
  std::vector<std::string> finish();

 private:
  void run();

  scene::Scene scene_;
  scene::PlacedCamera camera_;
  glm::ivec2 size_px_;
  eevee::Settings settings_;
  gpu::Backend backend_;
  std::atomic<float> progress_ = 0.0F;
  std::atomic<bool> is_cancelled_ = false;
  std::atomic<bool> is_done_ = false;
  mutable std::mutex mutex_;
  /** Guarded by mutex_. */
  std::vector<measure::TimedError> points_;
  /** The measurement's thread owns these until it is joined. */
  std::vector<std::string> untraced_;
  std::exception_ptr error_;
  std::thread thread_;
};

}  // namespace gnomon::view
