// SPDX-License-Identifier: MIT
#pragma once

#include "measure_report.hh"
#include "measure_technique.hh"

#include "gpu_device.hh"
#include "reference_light.hh"

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

/** Chooses the shadow technique and the number of samples of a picture for a required error or time. */
namespace gnomon::measure {

/** RMSE over R, G and B, estimated from a sample of the pixels. */
struct SampledError {
  double rmse = 0.0;
  /** Standard deviation of rmse. */
  double standard_error = 0.0;
};

/**
 * A sample of a picture's pixels with their reference radiance, to estimate the error of pictures.
 *
 * The probability of a pixel rises with the local contrast of a guide picture, because errors are largest at edges; its
 * weight falls accordingly. Each pixel has two independent estimates of its radiance. Their product cancels the noise
 * of both, so that the error is that of the picture alone.
 */
class PixelSample {
 public:
  /**
   * \a guide: a picture of the scene; it may be noisy. \a seed: selects the pixels and the rays. \a has_multiscatter
   * and \a progress: see reference::DirectLightSettings.
   * \pre sample_count >= 1, pixel_count >= 2
   */
  PixelSample(const reference::Tracer &tracer, const scene::PlacedCamera &camera, glm::ivec2 size_px,
              std::span<const glm::vec4> guide, int pixel_count, int sample_count, std::uint64_t seed,
              bool has_multiscatter = false, const std::function<void(double share_done)> &progress = {});

  /** Error of \a picture, which has the size given to the constructor. NaN if a sampled pixel is NaN. */
  [[nodiscard]] SampledError error(std::span<const glm::vec4> picture) const;

 private:
  /** Indices in the picture, whose rows begin at the bottom. */
  std::vector<std::size_t> pixels_;
  /** Weight of each pixel in the mean. The expectation of their sum is 1. */
  std::vector<double> weights_;
  std::array<std::vector<glm::vec4>, 2> light_;
};

/** Time and error of a technique on a scene, as functions of the number of samples. */
struct Model {
  Technique technique;
  /** A picture takes shadow_seconds + sample_count · sample_seconds. */
  double shadow_seconds = 0.0;
  double sample_seconds = 0.0;
  struct Point {
    int sample_count = 0;
    SampledError error;
  };
  /** In order of sample_count; at least one. */
  std::vector<Point> points;

  [[nodiscard]] double seconds(int sample_count) const;
  /**
   * Interpolates between two points by a power of the number of samples. Beyond the last point its error is returned.
   * \pre sample_count is at least that of the first point
   */
  [[nodiscard]] SampledError error(int sample_count) const;
};

/** The required error or time. Exactly one of them is set. */
struct Requirement {
  /** Largest RMSE. */
  std::optional<double> error_max;
  std::optional<double> seconds_max;
};

struct Choice {
  Technique technique;
  int sample_count = 1;
  double predicted_seconds = 0.0;
  SampledError predicted_error;
  /** true if the prediction meets the requirement; otherwise the choice is the nearest to it. */
  bool is_met = false;
};

/**
 * For a required error: the fastest picture whose predicted error plus two standard errors is at most that error. For a
 * required time: the picture with the least error within that time. \pre models is not empty
 */
[[nodiscard]] Choice choose(std::span<const Model> models, const Requirement &requirement);

struct Pilot {
  std::vector<Model> models;
  int picture_count = 0;
  double seconds = 0.0;
};

/**
 * Renders pictures with pilot_techniques() and 1, 2, 4, ... samples, no more than \a requirement needs. Per-lamp shadow
 * settings apply. \a has_multiscatter: of pictures and reference, see eevee::Settings.
 * \throws the exceptions of rendering, and std::runtime_error if no picture is finite.
 */
[[nodiscard]] Pilot run_pilot(gpu::Device &device, const scene::Scene &scene, const scene::PlacedCamera &camera,
                              glm::ivec2 size_px, const reference::Tracer &tracer, const Requirement &requirement,
                              bool has_multiscatter = false);

/**
 * The models of a report's techniques. Pictures with NaN or infinity and techniques without command line options are
 * left out.
 */
[[nodiscard]] std::vector<Model> models_from(const SceneReport &report);

}  // namespace gnomon::measure
