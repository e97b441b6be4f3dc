// SPDX-License-Identifier: MIT
#include "internal/measure_bench_meshes.hh"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <numbers>

namespace gnomon::measure {

Spread spread_of(std::vector<double> seconds)
{
  std::ranges::sort(seconds);
  const std::size_t last = seconds.size() - 1;
  return {seconds[last / 2], seconds[last / 4], seconds[last - last / 4]};
}

double median_ratio(std::span<const double> seconds, std::span<const double> base)
{
  std::vector<double> ratios;
  for (std::size_t i = 0; i < seconds.size(); i++) {
    ratios.push_back(seconds[i] / base[i]);
  }
  return spread_of(std::move(ratios)).median;
}

double now(Clock clock)
{
  if (clock == Clock::Wall) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

static gpu::Batch column_batch(gpu::Device &device, int sides)
{
  std::vector<glm::vec3> positions;
  std::vector<std::uint32_t> indices;
  const auto n = std::uint32_t(sides);
  for (std::uint32_t i = 0; i < n; i++) {
    const float angle = 2.0F * std::numbers::pi_v<float> * float(i) / float(n);
    for (const float z : {-0.3F, 0.3F}) {
      positions.emplace_back(0.3F * std::cos(angle), 0.3F * std::sin(angle), z);
    }
    const std::uint32_t here = 2 * i;
    const std::uint32_t next = 2 * ((i + 1) % n);
    indices.insert(indices.end(), {here, next, next + 1, here, next + 1, here + 1});
    if (i > 0 && i + 1 < n) {
      indices.insert(indices.end(), {0, next, here, 1, here + 1, next + 1});
    }
  }
  return device.create_batch(
      {.name = fmt::format("column of {}", sides), .positions = positions, .normals = {}, .indices = indices});
}

std::vector<gpu::Batch> column_batches(gpu::Device &device)
{
  std::vector<gpu::Batch> batches;
  for (int i = 0; i < bench_mesh_count; i++) {
    batches.push_back(column_batch(device, 3 + i));
  }
  return batches;
}

}  // namespace gnomon::measure
