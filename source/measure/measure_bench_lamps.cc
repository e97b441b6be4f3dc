// SPDX-License-Identifier: MIT
#include "internal/measure_bench_meshes.hh"

#include "eevee_light_shared.h"
#include "measure_scene.hh"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

namespace gnomon::measure {

namespace {

constexpr glm::ivec2 hall_size_px(320, 180);
constexpr double height_m = 6.0;
constexpr const char *fixed_hall = "90 m";

/** Point lamps with a range at random places below the roof of a square hall, seen from the middle of a side. */
scene::Scene hall(double edge_m, int lamp_count)
{
  scene::Scene scene;
  scene::Material material;
  material.name = "wall";
  material.base_color = glm::vec3(0.6F);
  material.metallic = 0.0F;
  material.roughness = 0.5F;
  const auto box = add_box_mesh(scene, scene.add(std::move(material)));
  const auto add_box = [&](const glm::dvec3 &center, const glm::dvec3 &half_size) {
    add_object(scene, box, glm::scale(glm::translate(glm::dmat4(1.0), center), half_size));
  };
  const double half = 0.5 * edge_m;
  for (const double y : {-0.1, height_m + 0.1}) {
    add_box({0.0, y, -half}, {half, 0.1, half});
  }
  for (const double side : {-1.0, 1.0}) {
    add_box({side * (half + 0.1), 0.5 * height_m, -half}, {0.1, 0.5 * height_m, half});
  }
  add_box({0.0, 0.5 * height_m, -edge_m - 0.1}, {half, 0.5 * height_m, 0.1});
  // Columns near the camera only, so that the number of objects does not grow with the hall.
  for (int i = 0; i < 64; i++) {
    const glm::dvec3 center(10.0 * (i % 8) - 35.0, 0.5 * height_m, -10.0 * (i / 8 + 1) + 5.0);
    if (std::abs(center.x) < half && center.z > -edge_m) {
      add_box(center, {0.4, 0.5 * height_m, 0.4});
    }
  }
  std::mt19937 random(1);
  const auto in = [&](double low, double high) { return low + (high - low) * double(random()) / double(random.max()); };
  for (int i = 0; i < lamp_count; i++) {
    const double x = in(-half, half);
    const double z = in(-edge_m, 0.0);
    const auto lamp = add_lamp(scene, scene::LampKind::Point, glm::vec3(x, 4.0, z), {0, -1, 0}, 30.0F);
    scene.edit(lamp, [](scene::Lamp &value) { value.range = float(bench_lamp_range_m); });
  }
  add_camera(scene, camera_at({0.0F, 3.0F, -0.5F}, {0.0F, 2.0F, -20.0F}));
  return scene;
}

/** A hall that was drawn before. */
class Hall {
 public:
  Hall(gpu::Device &device, const LampsCost &cost, int clustered_lamps_min)
      : device_(device),
        scene_(hall(cost.edge_m, cost.lamp_count)),
        camera_(scene_.placed_cameras().front()),
        renderer_(device, scene_, hall_size_px,
                  {.shadow = {.cube_size_px = 64}, .clustered_lamps_min = clustered_lamps_min})
  {
    renderer_.sync();
    renderer_.draw(camera_);
    device.finish();
  }
  double seconds()
  {
    const double start = now(Clock::Wall);
    renderer_.draw(camera_);
    device_.finish();
    return now(Clock::Wall) - start;
  }
  [[nodiscard]] std::size_t non_finite_count()
  {
    return Picture{hall_size_px, renderer_.read_picture()}.non_finite_count();
  }

 private:
  gpu::Device &device_;
  scene::Scene scene_;
  scene::PlacedCamera camera_;
  eevee::SceneRenderer renderer_;
};

/** Seconds until a frame of a new hall, as the engine draws it, is complete. The scene is made beforehand. */
double seconds_of_first(gpu::Device &device, const LampsCost &cost)
{
  const scene::Scene scene = hall(cost.edge_m, cost.lamp_count);
  device.finish();
  const double start = now(Clock::Wall);
  eevee::SceneRenderer renderer(device, scene, hall_size_px, {.shadow = {.cube_size_px = 64}});
  renderer.sync();
  renderer.draw(scene.placed_cameras().front());
  device.finish();
  return now(Clock::Wall) - start;
}

}  // namespace

std::vector<LampsCost> measure_lamps(gpu::Device &device, int rounds)
{
  std::vector<LampsCost> costs;
  for (const int count : {8, 32, 128}) {
    costs.push_back({.hall = fixed_hall, .lamp_count = count, .edge_m = 90.0});
  }
  for (const int count : {1, 8, 32, 128, 1024, 10000}) {
    costs.push_back({.hall = "growing", .lamp_count = count, .edge_m = 90.0 * std::sqrt(count / 128.0)});
  }
  std::vector<std::unique_ptr<Hall>> halls;
  std::vector<std::unique_ptr<Hall>> halls_of_all;
  for (LampsCost &cost : costs) {
    const std::size_t before = device.memory_bytes();
    cost.has_lists = cost.lamp_count >= eevee::Settings().clustered_lamps_min;
    halls.push_back(std::make_unique<Hall>(device, cost, 1));
    cost.memory_bytes = device.memory_bytes() - before;
    cost.non_finite_count = halls.back()->non_finite_count();
    halls_of_all.push_back(
        cost.lamp_count <= LIGHT_MAX ? std::make_unique<Hall>(device, cost, std::numeric_limits<int>::max()) : nullptr);
  }
  for (int round = 0; round < rounds; round++) {
    for (std::size_t i = 0; i < costs.size(); i++) {
      if (costs[i].hall == fixed_hall) {
        costs[i].seconds_of_first.push_back(seconds_of_first(device, costs[i]));
      }
      costs[i].seconds_of_lists.push_back(halls[i]->seconds());
      if (halls_of_all[i]) {
        costs[i].seconds_of_all.push_back(halls_of_all[i]->seconds());
      }
    }
  }
  return costs;
}

double growth_exponent(std::span<const double> counts, std::span<const double> seconds)
{
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (std::size_t i = 0; i < counts.size(); i++) {
    mean_x += std::log(counts[i]) / double(counts.size());
    mean_y += std::log(seconds[i]) / double(counts.size());
  }
  double products = 0.0;
  double squares = 0.0;
  for (std::size_t i = 0; i < counts.size(); i++) {
    products += (std::log(counts[i]) - mean_x) * (std::log(seconds[i]) - mean_y);
    squares += (std::log(counts[i]) - mean_x) * (std::log(counts[i]) - mean_x);
  }
  return products / squares;
}

}  // namespace gnomon::measure
