// SPDX-License-Identifier: MIT
#include "internal/measure_bench_meshes.hh"
#include "internal/measure_temporary_folder.hh"

#include "gltf_export.hh"
#include "gltf_import.hh"
#include "measure_scene.hh"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace gnomon::measure {

namespace {

/** Boxes on the points of a cubic lattice with a distance of 1 m. */
struct Lattice {
  scene::Scene scene;
  double edge_m = 0.0;

  [[nodiscard]] scene::PlacedCamera camera(double shift_m, bool sees_boxes) const
  {
    const glm::dvec3 middle(0.5 * edge_m);
    const glm::dvec3 eye = middle + glm::dvec3(shift_m, 0.0, 2.0 * edge_m + 2.0);
    return camera_at(glm::vec3(eye), glm::vec3(sees_boxes ? middle : 2.0 * eye - middle));
  }
};

Lattice lattice(int count)
{
  Lattice result;
  const int edge = int(std::ceil(std::cbrt(double(count)) - 1e-9));
  result.edge_m = edge;
  const auto box = add_box_mesh(result.scene, add_material(result.scene, glm::vec3(0.6F)));
  for (int i = 0; i < count; i++) {
    const glm::dvec3 place(i % edge, i / edge % edge, i / (edge * edge));
    add_object(result.scene, box, glm::scale(glm::translate(glm::dmat4(1.0), place), glm::dvec3(0.3)));
  }
  return result;
}

/** Seconds of \a work on \a clock. */
double timed(Clock clock, const std::function<void()> &work)
{
  const double start = now(clock);
  work();
  return now(clock) - start;
}

/**
 * Returns free memory to the system, so that work of each size pays for the memory that it touches, as the first work
 * of a process. Otherwise, the C library would keep the memory that small counts need, and return that of large ones.
 */
void forget_memory()
{
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

/** Measures each count of \a counts in turn in each round. \a measure: seconds for the count of this index. */
GrowthCost rounds_of(std::string work, std::vector<double> counts, int rounds,
                     const std::function<double(std::size_t index)> &measure)
{
  GrowthCost cost{.work = std::move(work), .counts = std::move(counts)};
  cost.seconds.resize(cost.counts.size());
  for (int round = 0; round <= rounds; round++) {
    for (std::size_t i = 0; i < cost.counts.size(); i++) {
      const double seconds = measure(i);
      // The first warms up.
      if (round > 0) {
        cost.seconds[i].push_back(seconds);
      }
    }
  }
  return cost;
}

/** The values of \a counts up to \a most. */
std::vector<double> up_to(double most, std::vector<double> counts)
{
  std::erase_if(counts, [most](double count) { return count > most; });
  return counts;
}

std::vector<double> object_counts(double most)
{
  return up_to(most, {10, 100, 1000, 10000, 100000});
}

constexpr glm::ivec2 view_size_px(640, 360);

std::vector<Lattice> lattices_of(const std::vector<double> &counts)
{
  std::vector<Lattice> lattices;
  std::ranges::transform(counts, std::back_inserter(lattices), [](double count) { return lattice(int(count)); });
  return lattices;
}

/** Synchronised renderers of \a lattices, which must outlive them. */
std::vector<std::unique_ptr<eevee::SceneRenderer>> renderers_of(gpu::Device &device,
                                                                const std::vector<Lattice> &lattices)
{
  std::vector<std::unique_ptr<eevee::SceneRenderer>> renderers;
  for (const Lattice &one : lattices) {
    renderers.push_back(std::make_unique<eevee::SceneRenderer>(device, one.scene, view_size_px));
    renderers.back()->sync();
  }
  return renderers;
}

GrowthCost first_pictures(gpu::Device &device, int rounds, double most)
{
  const std::vector<double> counts = object_counts(most);
  const std::vector<Lattice> lattices = lattices_of(counts);
  return rounds_of("first picture, objects", counts, rounds, [&](std::size_t i) {
    forget_memory();
    return timed(Clock::ThreadCpu, [&] {
      eevee::SceneRenderer renderer(device, lattices[i].scene, view_size_px);
      renderer.sync();
      renderer.draw(lattices[i].camera(0.0, true));
    });
  });
}

/** All passes are recorded anew. */
GrowthCost changed_settings(gpu::Device &device, int rounds, double most)
{
  const std::vector<double> counts = object_counts(most);
  const std::vector<Lattice> lattices = lattices_of(counts);
  const std::vector<std::unique_ptr<eevee::SceneRenderer>> renderers = renderers_of(device, lattices);
  return rounds_of("picture after a change of settings, objects", counts, rounds, [&](std::size_t i) {
    eevee::Settings settings = renderers[i]->settings();
    settings.seed++;
    return timed(Clock::ThreadCpu, [&] {
      renderers[i]->set_settings(settings);
      renderers[i]->sync();
      renderers[i]->draw(lattices[i].camera(0.0, true));
    });
  });
}

GrowthCost moving_cameras(gpu::Device &device, int rounds, double most)
{
  const std::vector<double> counts = object_counts(most);
  const std::vector<Lattice> lattices = lattices_of(counts);
  const std::vector<std::unique_ptr<eevee::SceneRenderer>> renderers = renderers_of(device, lattices);
  double shift_m = 0.0;
  return rounds_of("picture of a moving camera, objects", counts, rounds, [&](std::size_t i) {
    shift_m += 1e-3;
    const scene::PlacedCamera camera = lattices[i].camera(shift_m, true);
    return timed(Clock::ThreadCpu, [&] { renderers[i]->draw(camera); });
  });
}

/** The view shows a square, so that the time is that of the shadow. */
GrowthCost moving_lamps(gpu::Device &device, int rounds, double most)
{
  const std::vector<double> counts = object_counts(most);
  std::vector<Lattice> lattices = lattices_of(counts);
  std::vector<scene::Handle<scene::Node>> nodes;
  for (Lattice &one : lattices) {
    const glm::dvec3 middle(0.5 * one.edge_m);
    add_lamp(one.scene, scene::LampKind::Point, glm::vec3(middle), {0, 0, -1}, 100.0F);
    nodes.push_back(one.scene.placed_lamps().front().node);
    const auto square = add_square_mesh(one.scene, add_material(one.scene, glm::vec3(0.6F)));
    const glm::dvec3 behind = middle + glm::dvec3(0.0, 0.0, 2.0 * one.edge_m + 6.0);
    add_object(one.scene, square, glm::translate(glm::dmat4(1.0), behind));
  }
  const std::vector<std::unique_ptr<eevee::SceneRenderer>> renderers = renderers_of(device, lattices);
  return rounds_of("picture after a move of a lamp, casters", counts, rounds, [&](std::size_t i) {
    lattices[i].scene.edit(nodes[i], [](scene::Node &node) { node.parent_from_node[3].x += 1e-3; });
    const scene::PlacedCamera camera = lattices[i].camera(0.0, false);
    return timed(Clock::ThreadCpu, [&] {
      renderers[i]->sync();
      renderers[i]->draw(camera);
    });
  });
}

GrowthCost imports(int rounds, double most)
{
  const std::vector<double> counts = up_to(most, {10, 100, 1e3, 1e4, 1e5, 1e6});
  const TemporaryFolder folder;
  const auto path_of = [&](std::size_t i) { return folder.path / fmt::format("{}.glb", i); };
  for (std::size_t i = 0; i < counts.size(); i++) {
    gltf::export_gltf(lattice(int(counts[i])).scene, path_of(i));
  }
  return rounds_of("import, nodes of one mesh", counts, rounds, [&](std::size_t i) {
    forget_memory();
    return timed(Clock::Wall, [&] { static_cast<void>(gltf::import_gltf(path_of(i))); });
  });
}

/** Boxes on a ground under a sun and a point lamp with shadows. */
Lattice lit_lattice()
{
  Lattice result = lattice(100);
  add_lamp(result.scene, scene::LampKind::Sun, {0, 0, 9}, {0.3F, 0.4F, -1.0F}, 2.0F);
  add_lamp(result.scene, scene::LampKind::Point, {2.5F, 2.5F, 8.0F}, {0, 0, -1}, 100.0F);
  return result;
}

GrowthCost pictures_of_pixels(gpu::Device &device, int rounds, double most)
{
  const Lattice one = lit_lattice();
  const std::vector<double> counts = up_to(most, {128 * 128, 256 * 256, 512 * 512, 1024 * 1024, 2048 * 2048});
  std::vector<std::unique_ptr<eevee::SceneRenderer>> renderers;
  for (const double count : counts) {
    const glm::ivec2 size_px(int(std::lround(std::sqrt(count))));
    renderers.push_back(std::make_unique<eevee::SceneRenderer>(device, one.scene, size_px));
    renderers.back()->sync();
  }
  return rounds_of("warm picture, pixels", counts, rounds, [&](std::size_t i) {
    return timed(Clock::Wall, [&] {
      renderers[i]->draw(one.camera(0.0, true));
      device.finish();
    });
  });
}

GrowthCost pictures_of_samples(gpu::Device &device, int rounds, double most)
{
  const Lattice one = lit_lattice();
  const std::vector<double> counts = up_to(most, {1, 4, 16, 64, 256});
  std::vector<std::unique_ptr<eevee::SceneRenderer>> renderers;
  for (const double count : counts) {
    renderers.push_back(std::make_unique<eevee::SceneRenderer>(device, one.scene, glm::ivec2(128, 72),
                                                               eevee::Settings{.sample_count = int(count)}));
    renderers.back()->sync();
  }
  return rounds_of("warm picture, samples", counts, rounds, [&](std::size_t i) {
    return timed(Clock::Wall, [&] {
      renderers[i]->draw(one.camera(0.0, true));
      device.finish();
    });
  });
}

}  // namespace

std::vector<double> GrowthCost::medians() const
{
  std::vector<double> result;
  for (const std::vector<double> &of_count : seconds) {
    result.push_back(spread_of(of_count).median);
  }
  return result;
}

Growth growth_of(std::span<const double> counts, std::span<const double> seconds)
{
  const double most = std::ranges::max(counts);
  Growth best;
  double least = std::numeric_limits<double>::infinity();
  constexpr double step = 0.005;
  for (double exponent = step; exponent <= 3.0; exponent += step) {
    // Weighted least squares of fixed and factor. Dividing by the time makes the errors relative.
    double aa = 0.0;
    double ab = 0.0;
    double bb = 0.0;
    double a = 0.0;
    double b = 0.0;
    for (std::size_t i = 0; i < counts.size(); i++) {
      const double one = 1.0 / seconds[i];
      const double x = std::pow(counts[i] / most, exponent) / seconds[i];
      aa += one * one;
      ab += one * x;
      bb += x * x;
      a += one;
      b += x;
    }
    const double fixed = std::max((a * bb - b * ab) / (aa * bb - ab * ab), 0.0);
    const double factor = (b - fixed * ab) / bb;
    double error = 0.0;
    for (std::size_t i = 0; i < counts.size(); i++) {
      const double fitted = fixed + factor * std::pow(counts[i] / most, exponent);
      error += (fitted / seconds[i] - 1.0) * (fitted / seconds[i] - 1.0);
    }
    if (error < least) {
      least = error;
      best = {fixed, exponent};
    }
  }
  return best;
}

std::vector<GrowthCost> measure_growth(gpu::Device *device, int rounds, double count_max)
{
  const std::unique_ptr<gpu::Device> null_device = gpu::create_null_device();
  std::vector<GrowthCost> costs;
  costs.push_back(first_pictures(*null_device, rounds, count_max));
  costs.push_back(changed_settings(*null_device, rounds, count_max));
  costs.push_back(moving_cameras(*null_device, rounds, count_max));
  costs.push_back(moving_lamps(*null_device, rounds, count_max));
  costs.push_back(imports(rounds, count_max));
  if (device != nullptr) {
    costs.push_back(pictures_of_pixels(*device, rounds, count_max));
    costs.push_back(pictures_of_samples(*device, rounds, count_max));
  }
  return costs;
}

}  // namespace gnomon::measure
