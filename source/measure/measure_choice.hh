// SPDX-License-Identifier: MIT
#pragma once

#include "measure_report.hh"
#include "measure_technique.hh"

#include "gpu_device.hh"
#include "reference_light.hh"

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

/** How many samples and which shadows a picture of a scene needs for an error that is asked for, or a time. */
namespace gnomon::measure {

/** RMSE over R, G and B, estimated from some pixels. */
struct SampledError {
  double rmse = 0.0;
  /** Of rmse, one standard deviation. */
  double standard_error = 0.0;
};

/**
 * Some pixels of a picture, and what exact rays find there.
 *
 * Pixels are taken more often where a picture has edges, as its errors are there, and count less in return. Two
 * independent estimates of each pixel's light, multiplied, cancel the noise of either: the error is that of the
 * picture alone.
 */
class PixelSample {
 public:
  /**
   * \a guide: a picture of the scene, the rougher the quicker. \a seed: another takes other pixels and other rays.
   * \pre sample_count >= 1, pixel_count >= 2
   */
  PixelSample(const reference::Tracer &tracer, const scene::PlacedCamera &camera, glm::ivec2 size_px,
              std::span<const glm::vec4> guide, int pixel_count, int sample_count, std::uint64_t seed);

  /** Of a picture of that size. NaN where a pixel is. */
  [[nodiscard]] SampledError error(std::span<const glm::vec4> picture) const;

 private:
  /** In rows from the bottom. */
  std::vector<std::size_t> pixels_;
  /** Of each: its part of the mean. They sum to 1 in expectation. */
  std::vector<double> weights_;
  std::array<std::vector<glm::vec4>, 2> light_;
};

/** What is known of a technique on a scene: its times, and its error for some numbers of samples. */
struct Model {
  Technique technique;
  /** A picture takes shadow_seconds + n · sample_seconds. */
  double shadow_seconds = 0.0;
  double sample_seconds = 0.0;
  struct Point {
    int sample_count = 0;
    SampledError error;
  };
  /** In order of the samples; at least one. */
  std::vector<Point> points;

  [[nodiscard]] double seconds(int sample_count) const;
  /**
   * Between two points a power of the samples; beyond the last, nothing is known, and its error is given.
   * \pre sample_count is at least that of the first point
   */
  [[nodiscard]] SampledError error(int sample_count) const;
};

/** What was asked for; one of them. */
struct Wish {
  /** RMSE. */
  std::optional<double> error_max;
  std::optional<double> seconds_max;
};

struct Choice {
  Technique technique;
  int sample_count = 1;
  double predicted_seconds = 0.0;
  SampledError predicted_error;
  /** Whether the prediction is what was asked for; otherwise it is the nearest to it. */
  bool is_met = false;
};

/**
 * The fastest picture whose predicted error, and twice its standard error, are below what was asked for; or the one
 * with the least error in that time. \pre models is not empty
 */
[[nodiscard]] Choice choose(std::span<const Model> models, const Wish &wish);

struct Pilot {
  std::vector<Model> models;
  int picture_count = 0;
  double seconds = 0.0;
};

/**
 * Try pilot_techniques() with 1, 2, 4, ... samples, no more than \a wish needs. Lamps' own wishes hold.
 * Throws what rendering throws, and std::runtime_error where no picture is finite.
 */
[[nodiscard]] Pilot run_pilot(gpu::Device &device, const scene::Scene &scene, const scene::PlacedCamera &camera,
                              glm::ivec2 size_px, const reference::Tracer &tracer, const Wish &wish);

/** What a report knows of a scene. Left out: pictures that held NaN or infinity, techniques that no option chooses. */
[[nodiscard]] std::vector<Model> models_from(const SceneReport &report);

}  // namespace gnomon::measure
