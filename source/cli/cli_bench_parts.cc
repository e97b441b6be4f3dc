// SPDX-License-Identifier: MIT
// The groups of `gnomon bench` that compare parts of the engine with a baseline.
#include "cli_bench.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <initializer_list>
#include <memory>
#include <vector>

namespace gnomon::cli {

namespace {

/** Prints one line for each part, with the ratio to the first. \return the same as JSON */
nlohmann::json print_parts(const std::vector<measure::PartCost> &parts, double unit)
{
  nlohmann::json rows = nlohmann::json::array();
  for (const measure::PartCost &part : parts) {
    const measure::Spread spread = measure::spread_of(part.seconds);
    const double ratio = measure::median_ratio(part.seconds, parts.front().seconds);
    fmt::print("  {:<44} {:<30} {:>6.2f}\n", part.what, to_text(spread, unit), ratio);
    rows.push_back({{"what", part.what}, {"seconds", to_json(spread)}, {"ratio_to_first", ratio}});
  }
  return rows;
}

}  // namespace

void bench_record(const BenchOptions &options)
{
  constexpr int draw_count = 10000;
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  fmt::print(
      "{} draws, each with a matrix of its own: CPU nanoseconds a draw, median [quartiles] of {} rounds, and the ratio "
      "to the\nfirst line. Drawn: recorded for a view, and submitted; {}\n",
      draw_count, options.rounds, device->description());
  const nlohmann::json rows = print_parts(measure::measure_record(*device, draw_count, options.rounds), 1e-9);
  write_json(options.json, {{"program", "gnomon " GNOMON_VERSION},
                            {"bench", "record"},
                            {"rounds", options.rounds},
                            {"draws", draw_count},
                            {"rows", rows}});
}

/** Measures \a measured for each of \a counts up to the largest asked for. \a things: for example "boxes". */
static void bench_counts(const BenchOptions &options, const char *name, const char *things,
                         std::initializer_list<int> counts, double unit,
                         std::vector<measure::PartCost> (*measured)(int count, int rounds))
{
  nlohmann::json json = nlohmann::json::array();
  for (const int count : counts) {
    if (count <= options.count_max) {
      fmt::print("{} {}\n", count, things);
      json.push_back({{"count", count}, {"rows", print_parts(measured(count, options.rounds), unit)}});
    }
  }
  write_json(options.json,
             {{"program", "gnomon " GNOMON_VERSION}, {"bench", name}, {"rounds", options.rounds}, {"counts", json}});
}

void bench_cull(const BenchOptions &options)
{
  fmt::print(
      "Boxes around a camera, tested against its frustum: CPU microseconds, median [quartiles] of {} rounds, and the "
      "ratio\nto the first line\n",
      options.rounds);
  bench_counts(options, "cull", "boxes", {1000, 10000, 100000}, 1e-6, measure::measure_cull);
}

void bench_sync(const BenchOptions &options)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  fmt::print(
      "Syncs and pictures of {} point lamps among {} triangles: milliseconds, median [quartiles] of {} rounds, and the "
      "ratio to the "
      "first line.\n{}\n",
      measure::sync_lamp_count, measure::sync_triangle_count, options.rounds, device->description());
  const nlohmann::json rows = print_parts(measure::measure_sync(*device, options.rounds), 1e-3);
  write_json(options.json, {{"program", "gnomon " GNOMON_VERSION},
                            {"bench", "sync"},
                            {"rounds", options.rounds},
                            {"triangles", measure::sync_triangle_count},
                            {"lamps", measure::sync_lamp_count},
                            {"rows", rows}});
}

void bench_import(const BenchOptions &options)
{
  fmt::print(
      "Files of nodes of one mesh: milliseconds, median [quartiles] of {} rounds, and the ratio to the first line\n",
      options.rounds);
  bench_counts(options, "import", "nodes", {1000, 100000}, 1e-3, measure::measure_import);
}

}  // namespace gnomon::cli
