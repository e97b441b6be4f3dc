// SPDX-License-Identifier: MIT
#include "internal/measure_bench_meshes.hh"

#include "eevee_scene_renderer.hh"
#include "measure_left_out.hh"

#include <algorithm>
#include <limits>

namespace gnomon::measure {

namespace {

/**
 * Draws a first frame and some warm frames of \a one. \a cost: receives the results; times only if \a is_warm_up is
 * false.
 */
void draw_left_out(gpu::Device &device, const LeftOutCase &one, LeftOutCost &cost, bool is_warm_up)
{
  constexpr glm::ivec2 size_px(640, 360);
  const gpu::Counters before = device.counters();
  const double start = now(Clock::Wall);
  eevee::SceneRenderer renderer(device, one.scene, size_px, one.settings);
  const scene::PlacedCamera camera = one.scene.placed_cameras().front();
  renderer.sync();
  renderer.draw(camera);
  device.finish();
  const double first_end = now(Clock::Wall);
  const gpu::Counters &after = device.counters();
  cost.counters.passes = after.passes - before.passes;
  cost.counters.draws = after.draws - before.draws;
  cost.counters.shaders_made = after.shaders_made - before.shaders_made;
  cost.counters.textures_made = after.textures_made - before.textures_made;
  cost.counters.upload_bytes = after.upload_bytes - before.upload_bytes;
  cost.memory_bytes = device.memory_bytes();
  // The fastest of a few frames, because other programs only add time.
  double warm = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5; i++) {
    const double warm_start = now(Clock::Wall);
    renderer.draw(camera);
    device.finish();
    warm = std::min(warm, now(Clock::Wall) - warm_start);
  }
  if (!is_warm_up) {
    cost.first_seconds.push_back(first_end - start);
    cost.warm_seconds.push_back(warm);
  }
}

}  // namespace

std::vector<LeftOutCost> measure_left_out(gpu::Device &device, int rounds)
{
  const std::vector<LeftOutCase> cases = left_out_cases();
  std::vector<LeftOutCost> costs;
  for (const LeftOutCase &one : cases) {
    costs.push_back({.name = one.name, .counters = {}, .memory_bytes = 0, .first_seconds = {}, .warm_seconds = {}});
  }
  for (int round = 0; round <= rounds; round++) {
    for (std::size_t i = 0; i < cases.size(); i++) {
      draw_left_out(device, cases[i], costs[i], round == 0);
    }
  }
  return costs;
}

}  // namespace gnomon::measure
