// SPDX-License-Identifier: MIT
#pragma once

#include "measure_error_time.hh"

#include <atomic>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace gnomon::view {

/**
 * A measurement of error against time on a thread of its own, with a device and an OpenGL context of its own, so that
 * the window stays alive. The thread has the lowest priority, so that the window's frames come first.
 *
 * Threads: all functions are called on one thread, the window's.
 */
class ErrorMeasurement {
 public:
  /** Begin to measure. \see measure::measure_error_time \throws std::system_error if there can be no other thread */
  ErrorMeasurement(scene::Scene scene, const scene::PlacedCamera &camera, glm::ivec2 size_px,
                   const eevee::Settings &settings);
  ErrorMeasurement(const ErrorMeasurement &) = delete;
  ErrorMeasurement &operator=(const ErrorMeasurement &) = delete;
  /** Cancels, and waits until the measurement has ended (\see cancel). */
  ~ErrorMeasurement();

  /** The part that is done, in [0, 1]. */
  [[nodiscard]] float progress() const
  {
    return progress_;
  }
  /** The pictures that are measured. */
  [[nodiscard]] std::vector<measure::TimedError> points() const;
  /** The measurement has ended: finish does not wait. */
  [[nodiscard]] bool is_done() const
  {
    return is_done_;
  }
  /** Let it end at most one sample or one traced pixel later; not while it compiles shaders or sorts triangles. */
  void cancel()
  {
    is_cancelled_ = true;
  }
  [[nodiscard]] bool is_cancelled() const
  {
    return is_cancelled_;
  }
  /**
   * Waits for the end. \return what the rays leave out, \see reference::untraced_parts \pre not called before
   * \throws as measure::measure_error_time, and gpu::Error if there can be no other context
   */
  std::vector<std::string> finish();

 private:
  void run();

  scene::Scene scene_;
  scene::PlacedCamera camera_;
  glm::ivec2 size_px_;
  eevee::Settings settings_;
  std::atomic<float> progress_ = 0.0F;
  std::atomic<bool> is_cancelled_ = false;
  std::atomic<bool> is_done_ = false;
  mutable std::mutex mutex_;
  /** Guarded by mutex_. */
  std::vector<measure::TimedError> points_;
  /** Of the measurement's thread, until it is joined. */
  std::vector<std::string> untraced_;
  std::exception_ptr error_;
  std::thread thread_;
};

}  // namespace gnomon::view
