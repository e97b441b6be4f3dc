// SPDX-License-Identifier: MIT
#pragma once

#include "measure_choice.hh"

#include "eevee_engine.hh"

#include <functional>
#include <stdexcept>
#include <vector>

/** Measures how the error of a picture falls with the time that it takes. */
namespace gnomon::measure {

/** Time and error of a picture. */
struct TimedError {
  int sample_count = 0;
  /** \see TechniqueTimes::picture_seconds */
  double seconds = 0.0;
  SampledError error;
};

/** A measurement that its host has cancelled. */
class Cancelled : public std::runtime_error {
 public:
  Cancelled() : std::runtime_error("the measurement was cancelled") {}
};

/** The calls of a running measurement to its host. Both are called by one thread at a time, which may be any. */
struct ErrorTimeHost {
  /** With the part that is done, in [0, 1], after each traced pixel and each sample. Returns false to cancel. */
  std::function<bool(double share_done)> progress{};
  /** With each picture. */
  std::function<void(const TimedError &point)> take{};
};

/** 1, 2, 4, ... as far as they are less than \a sample_count, then \a sample_count. \pre sample_count >= 1 */
[[nodiscard]] std::vector<int> rising_sample_counts(int sample_count);

/**
 * Renders pictures of \a scene with \a settings and rising_sample_counts(Settings::sample_count), and estimates their
 * errors from a sample of the pixels, whose light is traced. A picture is drawn before, so that nothing is compiled
 * during the measurement. The pictures have no background, since the reference has none. Rays leave out what
 * reference::untraced_parts lists, so that it counts as error.
 * \throws Cancelled; gpu::Error; std::runtime_error if the scene cannot be traced, or a picture has NaN or infinity
 */
void measure_error_time(gpu::Device &device, const scene::Scene &scene, const scene::PlacedCamera &camera,
                        glm::ivec2 size_px, const eevee::Settings &settings, const ErrorTimeHost &host);

}  // namespace gnomon::measure
