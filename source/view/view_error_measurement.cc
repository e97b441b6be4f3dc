// SPDX-License-Identifier: MIT
#include "view_error_measurement.hh"

#include "shader_check_spirv.hh"

#ifdef __linux__
#include <sys/resource.h>
#endif

#include <utility>

namespace gnomon::view {

namespace {

/** Lowers the priority of this thread and of those that it will begin. */
void lower_priority()
{
#ifdef __linux__
  // POSIX has one priority for a process, Linux one for each thread. After a failure, the priority stays unchanged.
  constexpr int lowest = 19;
  setpriority(PRIO_PROCESS, 0, lowest);
#endif
}

}  // namespace

ErrorMeasurement::ErrorMeasurement(scene::Scene scene, const scene::PlacedCamera &camera, glm::ivec2 size_px,
                                   const eevee::Settings &settings, gpu::Backend backend)
    : scene_(std::move(scene)), camera_(camera), size_px_(size_px), settings_(settings), backend_(backend)
{
  thread_ = std::thread([this] { run(); });
}

ErrorMeasurement::~ErrorMeasurement()
{
  cancel();
  if (thread_.joinable()) {
    thread_.join();
  }
}

std::vector<measure::TimedError> ErrorMeasurement::points() const
{
  const std::scoped_lock lock(mutex_);
  return points_;
}

void ErrorMeasurement::run()
{
  lower_priority();
  try {
    const std::unique_ptr<gpu::Device> device = gpu::create_device(
        {.backend = backend_, .compile_spirv = shader_check::compile_spirv, .sink = [](std::string_view /*text*/) {}});
    untraced_ = reference::untraced_parts(scene_);
    measure::ErrorTimeHost host;
    host.progress = [this](double share_done) {
      progress_ = float(share_done);
      return !is_cancelled_;
    };
    host.take = [this](const measure::TimedError &point) {
      const std::scoped_lock lock(mutex_);
      points_.push_back(point);
    };
    measure::measure_error_time(*device, scene_, camera_, size_px_, settings_, host);
  }
  catch (...) {
    error_ = std::current_exception();
  }
  is_done_ = true;
}

std::vector<std::string> ErrorMeasurement::finish()
{
  thread_.join();
  if (error_) {
    std::rethrow_exception(std::exchange(error_, nullptr));
  }
  return std::move(untraced_);
}

}  // namespace gnomon::view
