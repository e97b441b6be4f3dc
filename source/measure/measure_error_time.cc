// SPDX-License-Identifier: MIT
#include "measure_error_time.hh"

#include "internal/measure_technique_renderer.hh"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace gnomon::measure {

std::vector<int> rising_sample_counts(int sample_count)
{
  std::vector<int> counts;
  // In 64 bits, since the last doubling may exceed an int.
  for (std::int64_t count = 1; count < sample_count; count *= 2) {
    counts.push_back(int(count));
  }
  counts.push_back(sample_count);
  return counts;
}

void measure_error_time(gpu::Device &device, const scene::Scene &scene, const scene::PlacedCamera &camera,
                        glm::ivec2 size_px, const eevee::Settings &settings, const ErrorTimeHost &host)
{
  // The standard error of the RMSE is then some percent.
  const int pixel_count = std::clamp(size_px.x * size_px.y, 2, 4096);
  constexpr int reference_samples = 64;
  constexpr double traced_share = 0.25;
  const auto check = [&](double share_done) {
    if (host.progress && !host.progress(share_done)) {
      throw Cancelled();
    }
  };
  check(0.0);
  eevee::Settings drawn = settings;
  drawn.background = {};
  TechniqueRenderer renderer(device, scene, camera, drawn, size_px);
  renderer.warm_up(false);
  check(0.0);
  const reference::Tracer tracer(scene);
  const PixelSample sample(tracer, camera, size_px, renderer.picture(), pixel_count, reference_samples, 0,
                           settings.has_multiscatter, [&](double share_done) { check(traced_share * share_done); });

  const std::vector<int> counts = rising_sample_counts(settings.sample_count);
  double samples_total = 0.0;
  for (const int count : counts) {
    samples_total += double(count);
  }
  double samples_done = 0.0;
  for (const int count : counts) {
    TimedError point{count, 0.0, {}};
    point.seconds = renderer.picture_seconds(count, [&](int samples_drawn) {
      check(traced_share + (1.0 - traced_share) * (samples_done + double(samples_drawn)) / samples_total);
      return true;
    });
    samples_done += double(count);
    point.error = sample.error(renderer.picture());
    if (!std::isfinite(point.error.rmse)) {
      throw std::runtime_error(fmt::format("{}: the picture with {} samples holds NaN or infinity", scene.path, count));
    }
    if (host.take) {
      host.take(point);
    }
  }
}

}  // namespace gnomon::measure
