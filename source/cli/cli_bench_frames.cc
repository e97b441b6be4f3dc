// SPDX-License-Identifier: MIT
#include "cli_bench.hh"
#include "cli_device.hh"

#include "measure_frames.hh"
#include "output_roles.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

namespace gnomon::cli {

namespace {

nlohmann::json print_times(const char *what, const std::vector<double> &seconds)
{
  const auto at = [&](double share) { return measure::percentile(seconds, share); };
  fmt::print("  {:<28} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f}\n", what, 1e3 * at(0.5), 1e3 * at(0.95), 1e3 * at(0.99),
             1e3 * at(1.0));
  return {{"p50", at(0.5)}, {"p95", at(0.95)}, {"p99", at(0.99)}, {"longest", at(1.0)}};
}

void print_budget(const measure::BudgetTimes &times, nlohmann::json &json)
{
  json["moved_camera"] = print_times("the camera is moved, budget", times.moved_camera);
  json["refined"] = print_times("refining, budget", times.refined);
  fmt::print("  complete and still: {} draws, {} bytes uploaded\n", times.still.draws, times.still.upload_bytes);
  fmt::print("  the refined picture: RMS {:.6f}; of its difference to one without a budget {:.3g}\n", times.picture_rms,
             times.difference_rms);
  json["picture_rms"] = times.picture_rms;
  json["difference_rms"] = times.difference_rms;
  json["still"] = {{"draws", times.still.draws}, {"upload_bytes", times.still.upload_bytes}};
}

nlohmann::json print_scene(gpu::Device &device, const BenchOptions &options, const std::string &path)
{
  scene::Scene scene = import_scene(path, options.world);
  output::Roles roles;
  add_inputs(roles, scene, options.world);
  roles.add_output(options.json, "--json");
  light_by_world(scene, scene.placed_cameras().front(), options.world);
  const measure::FrameTimes times = measure::measure_frame_times(
      device, std::move(scene), {.frame_count = options.frames, .budget_seconds = 1e-3 * options.budget_ms});
  fmt::print("\n{:<30} {:>9} {:>9} {:>9} {:>9}\n", path, "p50", "p95", "p99", "longest");
  nlohmann::json json = {{"scene", path}};
  if (!times.moved_lamp.empty()) {
    json["control"] = print_times("control: clear", times.control);
    json["moved_lamp"] = print_times("one lamp is moved", times.moved_lamp);
    const auto spread = [](const std::vector<double> &seconds) {
      return measure::percentile(seconds, 0.99) - measure::percentile(seconds, 0.5);
    };
    json["small_arithmetic"] = print_times("control: arithmetic, 16 KiB", times.small_arithmetic);
    json["large_arithmetic"] = print_times("control: arithmetic, 512 KiB", times.large_arithmetic);
    json["uncached_arithmetic"] = print_times("control: arithmetic, 16 MiB", times.uncached_arithmetic);
    fmt::print("    p99 - p50: {:.2f} ms; of the controls {:.2f}, {:.2f}, {:.2f} and {:.2f} ms\n",
               1e3 * spread(times.moved_lamp), 1e3 * spread(times.control), 1e3 * spread(times.small_arithmetic),
               1e3 * spread(times.large_arithmetic), 1e3 * spread(times.uncached_arithmetic));
  }
  print_budget(times.moving, json);
  fmt::print("  with the shadows of gnomon render\n");
  print_budget(times.offline, json["offline"]);
  return json;
}

}  // namespace

void bench_frames(const BenchOptions &options)
{
  const std::unique_ptr<gpu::Device> device = create_device(options.backend);
  fmt::print(
      "Frames of a host at 640x360, milliseconds, of {} frames each, until the device is done. One lamp is moved: a\n"
      "whole sample. Budget: {} ms. Complete and still: {} further calls without a target. {}\n",
      options.frames, options.budget_ms, options.frames, device->description());
  nlohmann::json rows = nlohmann::json::array();
  for (const std::string &path : options.scenes) {
    rows.push_back(print_scene(*device, options, path));
  }
  write_json(options.json, {{"program", "gnomon " GNOMON_VERSION},
                            {"bench", "frames"},
                            {"frames", options.frames},
                            {"budget_seconds", 1e-3 * options.budget_ms},
                            {"device", device->description()},
                            {"rows", rows}});
}

}  // namespace gnomon::cli
