// SPDX-License-Identifier: MIT
#include "measure_frames.hh"

#include "draw_target.hh"
#include "eevee_scene_renderer.hh"
#include "internal/measure_bench_meshes.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>
#include <thread>

namespace gnomon::measure {

namespace {

/** Programs are compiled and textures made in these. A budget needs more of them, until it has found its plan. */
constexpr int warm_up_count = 30;
/**
 * Sleep before each frame, as a host that waits for the display. A process that never sleeps is interrupted by the
 * scheduler within its frames, whatever it draws.
 */
constexpr std::chrono::milliseconds idle_time{2};
/** Frames in which the camera stands still before it is moved again, so that pictures begin to refine. */
constexpr int refining_count = 10;
constexpr int budget_samples = 16;
/** Frames of a moved lamp for each run of arithmetic. */
constexpr int arithmetic_interval = 5;
/** Memory of a core: for its first and its second cache on common machines, and for neither. */
constexpr std::size_t small_bytes = std::size_t(16) << 10U;
constexpr std::size_t large_bytes = std::size_t(512) << 10U;
constexpr std::size_t uncached_bytes = std::size_t(16) << 20U;

/** Until the device is done. */
template <typename Work>
double seconds_of(gpu::Device &device, Work &&work)
{
  std::this_thread::sleep_for(idle_time);
  const double start = now(Clock::Wall);
  work();
  device.finish();
  return now(Clock::Wall) - start;
}

/** Multiplications of numbers in memory, as many on each core at the same time. */
class Arithmetic {
 public:
  /** A run takes about \a seconds, which must be positive. \a bytes: memory of one core */
  Arithmetic(std::size_t bytes, double seconds)
      : values_(std::max(1U, std::thread::hardware_concurrency()), std::vector<float>(bytes / sizeof(float), 1.0F))
  {
    const auto seconds_of_run = [this] {
      const double start = now(Clock::Wall);
      run();
      return now(Clock::Wall) - start;
    };
    // Longer than the start of the threads. The first runs also bring the memory into the caches.
    double measured = seconds_of_run();
    for (; measured < 0.5 * seconds; measured = seconds_of_run()) {
      round_count_ *= 2;
    }
    round_count_ = std::max(1, int(double(round_count_) * seconds / measured));
  }

  void run()
  {
    // This thread multiplies, too: new threads on all cores would at first share some of them.
    std::vector<std::jthread> threads;
    for (std::size_t core = 1; core < values_.size(); core++) {
      threads.emplace_back([this, core] { multiply(values_[core]); });
    }
    multiply(values_[0]);
  }

 private:
  void multiply(std::vector<float> &values) const
  {
    for (int round = 0; round < round_count_; round++) {
      for (float &value : values) {
        value = value * 0.5F + 0.5F;
      }
    }
  }

  /** For each core. */
  std::vector<std::vector<float>> values_;
  int round_count_ = 1;
};

gpu::Counters between(const gpu::Counters &before, const gpu::Counters &after)
{
  gpu::Counters counters;
  counters.passes = after.passes - before.passes;
  counters.draws = after.draws - before.draws;
  counters.upload_bytes = after.upload_bytes - before.upload_bytes;
  return counters;
}

class Frames {
 public:
  Frames(gpu::Device &device, scene::Scene scene, const FrameTimesSettings &settings)
      : device_(device),
        settings_(settings),
        scene_(std::move(scene)),
        start_(scene_.placed_cameras().front()),
        picture_(device, "picture", gpu::Format::RGBA8, settings.size_px)
  {
  }

  FrameTimes measure()
  {
    FrameTimes times;
    measure_lamp(times);
    measure_budget({.sample_count = budget_samples}, times.moving);
    measure_budget(eevee::offline_settings(budget_samples), times.offline);
    return times;
  }

 private:
  void clear()
  {
    gpu::CommandList list;
    draw::begin_pass(list, "control", picture_.target(), settings_.size_px, {}, {});
    list.end_pass();
    device_.submit(list);
  }

  void measure_lamp(FrameTimes &times)
  {
    const std::vector<scene::PlacedLamp> lamps = scene_.placed_lamps();
    if (lamps.empty()) {
      return;
    }
    const auto point = std::ranges::find(lamps, scene::LampKind::Point, &scene::PlacedLamp::kind);
    const scene::Handle<scene::Node> node = (point == lamps.end() ? lamps.begin() : point)->node;
    const glm::dmat4 start = scene_.nodes()[node].parent_from_node;
    eevee::SceneRenderer renderer(device_, scene_, settings_.size_px, {.sample_count = 1});
    std::vector<double> warm_up;
    std::optional<Arithmetic> small;
    std::optional<Arithmetic> large;
    std::optional<Arithmetic> uncached;
    for (int i = -warm_up_count; i < settings_.frame_count; i++) {
      const double control = seconds_of(device_, [&] { clear(); });
      const double frame = seconds_of(device_, [&] {
        // A circle of 0.2 m around the lamp's own -Z axis, and a turn around its X axis, which moves suns.
        const double angle = 0.1 * i;
        const glm::dmat4 moved = glm::translate(start, {0.2 * std::cos(angle), 0.2 * std::sin(angle), 0.0});
        scene_.set_transform(node, glm::rotate(moved, 0.02 * std::sin(angle), {1, 0, 0}));
        renderer.sync();
        renderer.draw_sample(start_, picture_.target());
      });
      if (i < 0) {
        warm_up.push_back(frame);
        continue;
      }
      times.control.push_back(control);
      times.moved_lamp.push_back(frame);
      if (i == 0) {
        small.emplace(small_bytes, percentile(warm_up, 0.5));
        large.emplace(large_bytes, percentile(warm_up, 0.5));
        uncached.emplace(uncached_bytes, percentile(warm_up, 0.5));
      }
      if (i % arithmetic_interval == 0) {
        times.small_arithmetic.push_back(seconds_of(device_, [&] { small->run(); }));
        times.large_arithmetic.push_back(seconds_of(device_, [&] { large->run(); }));
        times.uncached_arithmetic.push_back(seconds_of(device_, [&] { uncached->run(); }));
      }
    }
    scene_.set_transform(node, start);
  }

  /** The camera after \a step steps of half a degree around the vertical axis through the middle of the scene. */
  [[nodiscard]] scene::PlacedCamera camera_at(int step) const
  {
    const glm::dvec3 middle(scene_.bounds().is_empty() ? glm::vec3(0.0F) : scene_.bounds().center());
    const glm::dmat4 turned = glm::rotate(glm::translate(glm::dmat4(1.0), middle),
                                          double(step) * std::numbers::pi / 360.0, glm::dvec3(0, 1, 0));
    scene::PlacedCamera camera = start_;
    camera.world_from_camera = glm::translate(turned, -middle) * start_.world_from_camera;
    return camera;
  }

  void measure_budget(const eevee::Settings &settings, BudgetTimes &times)
  {
    eevee::SceneRenderer renderer(device_, scene_, settings_.size_px, settings);
    const auto draw = [&](const scene::PlacedCamera &camera, const draw::Target &target) {
      return seconds_of(device_, [&] { renderer.draw_within(settings_.budget_seconds, camera, target); });
    };
    // The first use of programs is not measured.
    renderer.sync();
    renderer.draw_sample(start_, picture_.target());
    int step = 0;
    for (int i = -warm_up_count; i < settings_.frame_count; i++) {
      const double seconds = draw(camera_at(step++), picture_.target());
      if (i >= 0) {
        times.moved_camera.push_back(seconds);
      }
    }
    for (int i = -warm_up_count; i < settings_.frame_count; i++) {
      const bool is_moved = (i + warm_up_count) % (refining_count + 1) == 0;
      step += is_moved ? 1 : 0;
      const double seconds = draw(camera_at(step), picture_.target());
      if (i >= 0 && !is_moved) {
        times.refined.push_back(seconds);
      }
    }
    const scene::PlacedCamera camera = camera_at(step);
    while (!renderer.draw_within(settings_.budget_seconds, camera)) {
    }
    const gpu::Counters before = device_.counters();
    for (int i = 0; i < settings_.frame_count; i++) {
      renderer.draw_within(settings_.budget_seconds, camera);
    }
    times.still = between(before, device_.counters());
    eevee::SceneRenderer whole(device_, scene_, settings_.size_px, settings);
    whole.sync();
    whole.draw(camera);
    compare(renderer.read_picture(), whole.read_picture(), times);
  }

  static void compare(const std::vector<glm::vec4> &refined, const std::vector<glm::vec4> &whole, BudgetTimes &times)
  {
    double square = 0.0;
    double difference_square = 0.0;
    for (std::size_t i = 0; i < refined.size(); i++) {
      const glm::dvec3 difference(glm::dvec4(refined[i]) - glm::dvec4(whole[i]));
      square += glm::dot(glm::dvec3(refined[i]), glm::dvec3(refined[i]));
      difference_square += glm::dot(difference, difference);
    }
    times.picture_rms = std::sqrt(square / (3.0 * double(refined.size())));
    times.difference_rms = std::sqrt(difference_square / (3.0 * double(refined.size())));
  }

  gpu::Device &device_;
  FrameTimesSettings settings_;
  scene::Scene scene_;
  scene::PlacedCamera start_;
  draw::TargetTexture picture_;
};

}  // namespace

double percentile(std::vector<double> seconds, double share)
{
  std::ranges::sort(seconds);
  const auto rank = std::size_t(std::ceil(share * double(seconds.size())));
  return seconds[std::clamp<std::size_t>(rank, 1, seconds.size()) - 1];
}

FrameTimes measure_frame_times(gpu::Device &device, scene::Scene scene, const FrameTimesSettings &settings)
{
  return Frames(device, std::move(scene), settings).measure();
}

}  // namespace gnomon::measure
