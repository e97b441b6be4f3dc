// SPDX-License-Identifier: MIT
#include "measure_choice.hh"

#include "internal/measure_technique_renderer.hh"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

namespace gnomon::measure {

namespace {

/** Largest difference of each pixel from its neighbours. */
std::vector<double> contrast(std::span<const glm::vec4> picture, glm::ivec2 size_px)
{
  const auto at = [&](int x, int y) {
    return glm::vec3(picture[std::size_t(y) * std::size_t(size_px.x) + std::size_t(x)]);
  };
  std::vector<double> contrasts;
  contrasts.reserve(picture.size());
  for (int y = 0; y < size_px.y; y++) {
    for (int x = 0; x < size_px.x; x++) {
      const glm::vec3 here = at(x, y);
      float most = 0.0F;
      for (int to_y = std::max(y - 1, 0); to_y <= std::min(y + 1, size_px.y - 1); to_y++) {
        for (int to_x = std::max(x - 1, 0); to_x <= std::min(x + 1, size_px.x - 1); to_x++) {
          most = std::max(most, glm::length(at(to_x, to_y) - here));
        }
      }
      contrasts.push_back(std::isfinite(most) ? double(most) : 0.0);
    }
  }
  return contrasts;
}

}  // namespace

PixelSample::PixelSample(const reference::Tracer &tracer, const scene::PlacedCamera &camera, glm::ivec2 size_px,
                         std::span<const glm::vec4> guide, int pixel_count, int sample_count, std::uint64_t seed,
                         bool has_multiscatter, const std::function<void(double share_done)> &progress)
{
  const std::vector<double> contrasts = contrast(guide, size_px);
  double sum = 0.0;
  for (const double one : contrasts) {
    sum += one;
  }
  // Errors also occur where the guide has no edge, so part of the sample is distributed evenly.
  constexpr double even_share = 0.3;
  const auto count = double(contrasts.size());
  const auto probability = [&](std::size_t i) {
    return sum > 0.0 ? even_share / count + (1.0 - even_share) * contrasts[i] / sum : 1.0 / count;
  };
  // Systematic sampling: equal steps along the cumulative probability from a random start.
  std::mt19937_64 random(seed);
  const double start = double(random() >> 11U) * 0x1p-53;
  std::vector<glm::ivec2> places;
  double reached = 0.0;
  for (std::size_t i = 0; i < contrasts.size(); i++) {
    reached += probability(i) * pixel_count;
    while (start + double(pixels_.size()) < reached) {
      pixels_.push_back(i);
      weights_.push_back(1.0 / (probability(i) * count * pixel_count));
      places.emplace_back(int(i % std::size_t(size_px.x)), int(i / std::size_t(size_px.x)));
    }
  }
  for (std::size_t half = 0; half < 2; half++) {
    reference::DirectLightSettings settings{
        .sample_count = sample_count, .seed = 2 * seed + half + 1, .has_multiscatter = has_multiscatter};
    if (progress) {
      settings.progress = [&](double share_done) { progress(0.5 * (double(half) + share_done)); };
    }
    light_[half] = reference::direct_light(tracer, camera, size_px, places, settings);
  }
}

SampledError PixelSample::error(std::span<const glm::vec4> picture) const
{
  const auto count = double(pixels_.size());
  double sum = 0.0;
  double square_sum = 0.0;
  for (std::size_t i = 0; i < pixels_.size(); i++) {
    const glm::dvec3 here(picture[pixels_[i]]);
    const double product = glm::dot(here - glm::dvec3(light_[0][i]), here - glm::dvec3(light_[1][i])) / 3.0;
    const double part = weights_[i] * count * product;
    sum += part;
    square_sum += part * part;
  }
  const double mean = sum / count;
  const double variance = std::max(square_sum / count - mean * mean, 0.0) / (count - 1.0);
  const double rmse = std::sqrt(std::max(mean, 0.0));
  // d sqrt(m) = dm / (2 sqrt(m)); where the noise is larger than the error, sqrt(dm) bounds it.
  const double deviation = std::sqrt(variance);
  return {rmse, std::isnan(mean) ? mean : std::min(deviation / std::max(2.0 * rmse, 1e-30), std::sqrt(deviation))};
}

double Model::seconds(int sample_count) const
{
  return shadow_seconds + sample_count * sample_seconds;
}

SampledError Model::error(int sample_count) const
{
  for (std::size_t i = 1; i < points.size(); i++) {
    const Point &low = points[i - 1];
    const Point &high = points[i];
    if (sample_count < high.sample_count) {
      const double share =
          std::log(double(sample_count) / low.sample_count) / std::log(double(high.sample_count) / low.sample_count);
      const auto between = [share](double a, double b) {
        return a > 0.0 && b > 0.0 ? a * std::pow(b / a, share) : std::lerp(a, b, share);
      };
      return {between(low.error.rmse, high.error.rmse), between(low.error.standard_error, high.error.standard_error)};
    }
  }
  return points.back().error;
}

namespace {

/** Upper bound of an error at two standard errors. */
double upper(const SampledError &error)
{
  return error.rmse + 2.0 * error.standard_error;
}

}  // namespace

Choice choose(std::span<const Model> models, const Requirement &requirement)
{
  std::vector<Choice> met;
  std::vector<Choice> all;
  for (const Model &model : models) {
    for (int n = model.points.front().sample_count; n <= model.points.back().sample_count; n++) {
      Choice one{model.technique, n, model.seconds(n), model.error(n), false};
      one.is_met = requirement.error_max ? upper(one.predicted_error) <= *requirement.error_max
                                         : one.predicted_seconds <= *requirement.seconds_max;
      (one.is_met ? met : all).push_back(one);
    }
  }
  const auto fastest = [](const Choice &one) { return one.predicted_seconds; };
  const auto nearest = [](const Choice &one) { return upper(one.predicted_error); };
  const bool is_by_time = requirement.error_max.has_value() != met.empty();
  const std::vector<Choice> &candidates = met.empty() ? all : met;
  return is_by_time ? *std::ranges::min_element(candidates, {}, fastest)
                    : *std::ranges::min_element(candidates, {}, nearest);
}

Pilot run_pilot(gpu::Device &device, const scene::Scene &scene, const scene::PlacedCamera &camera, glm::ivec2 size_px,
                const reference::Tracer &tracer, const Requirement &requirement, bool has_multiscatter)
{
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  constexpr int sample_count_max = 64;
  constexpr int pixel_count = 2048;
  constexpr int reference_samples = 64;
  Pilot pilot;
  std::unique_ptr<PixelSample> sample;
  double best_seconds = std::numeric_limits<double>::infinity();
  for (const Technique &technique : pilot_techniques()) {
    TechniqueRenderer renderer(device, scene, camera,
                               {.shadow = technique.settings, .has_multiscatter = has_multiscatter}, size_px);
    renderer.warm_up(false);
    if (!sample) {
      sample = std::make_unique<PixelSample>(tracer, camera, size_px, renderer.picture(), pixel_count,
                                             reference_samples, 0, has_multiscatter);
    }
    Model model{technique, 0.0, 0.0, {}};
    double first_seconds = 0.0;
    for (int n = 1; n <= sample_count_max; n *= 2) {
      const double seconds = renderer.picture_seconds(n);
      pilot.picture_count++;
      if (n == 1) {
        first_seconds = seconds;
        // One picture cannot separate the samples' time from the shadows'.
        model.sample_seconds = seconds;
      }
      else {
        model.sample_seconds = std::clamp((seconds - first_seconds) / (n - 1), 0.0, first_seconds);
        model.shadow_seconds = first_seconds - model.sample_seconds;
      }
      const SampledError error = sample->error(renderer.picture());
      if (!std::isfinite(error.rmse)) {
        break;
      }
      model.points.push_back({n, error});
      const double upper_error = upper(model.points.back().error);
      const bool is_enough =
          requirement.error_max ? upper_error <= *requirement.error_max : model.seconds(n) >= *requirement.seconds_max;
      best_seconds = requirement.error_max && is_enough ? std::min(best_seconds, model.seconds(n)) : best_seconds;
      // If more samples do not lower the error, the rest is the shadows' error.
      const bool is_idle =
          n > 4 && model.points.back().error.rmse > 0.95 * model.points[model.points.size() - 2].error.rmse;
      if (is_enough || is_idle || model.seconds(n) >= best_seconds) {
        break;
      }
    }
    if (!model.points.empty()) {
      pilot.models.push_back(std::move(model));
    }
    // Sizes rise: if one sample takes longer than a sufficient picture, so do all larger sizes.
    if (first_seconds >= best_seconds) {
      break;
    }
  }
  if (pilot.models.empty()) {
    throw std::runtime_error(fmt::format("{}: every picture of the pilot holds NaN or infinity", scene.path));
  }
  pilot.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return pilot;
}

std::vector<Model> models_from(const SceneReport &report)
{
  std::vector<Model> models;
  for (const TechniqueReport &technique : report.techniques) {
    if (technique.technique.options.empty()) {
      continue;
    }
    Model model{technique.technique, 0.0, 0.0, {}};
    std::vector<glm::dvec2> times;
    for (const PictureReport &picture : technique.pictures) {
      if (std::isfinite(picture.error.rmse) && !picture.seconds.empty()) {
        model.points.push_back({picture.sample_count, {picture.error.rmse, 0.0}});
        times.emplace_back(picture.sample_count, median(picture.seconds));
      }
    }
    if (times.empty()) {
      continue;
    }
    const glm::dvec2 &first = times.front();
    const glm::dvec2 &last = times.back();
    model.sample_seconds = times.size() > 1
                               ? std::clamp((last.y - first.y) / (last.x - first.x), 0.0, first.y / first.x)
                               : first.y / first.x;
    model.shadow_seconds = first.y - model.sample_seconds * first.x;
    models.push_back(std::move(model));
  }
  return models;
}

}  // namespace gnomon::measure
