// SPDX-License-Identifier: MIT
#include "cli.hh"

#include "cli_bench.hh"
#include "cli_device.hh"
#include "cli_output.hh"
#include "cli_system.hh"

#include "measure_bench.hh"
#include "measure_edits.hh"
#include "measure_start.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>

namespace gnomon::cli {

nlohmann::json to_json(const measure::Spread &spread)
{
  return {{"median", spread.median}, {"low", spread.low}, {"high", spread.high}};
}

std::string to_text(const measure::Spread &spread, double unit)
{
  return fmt::format("{:9.2f} [{:.2f}, {:.2f}]", spread.median / unit, spread.low / unit, spread.high / unit);
}

namespace {

/** Prints one measurement, with ratios to the first two variants. */
nlohmann::json print_lamps(const std::vector<measure::LayerPassCost> &rows, int caster_count, const char *what,
                           double unit)
{
  nlohmann::json json = nlohmann::json::array();
  const measure::Spread base = measure::spread_of(rows[0].seconds);
  const measure::Spread six = measure::spread_of(rows[1].seconds);
  for (const measure::LayerPassCost &row : rows) {
    const measure::Spread spread = measure::spread_of(row.seconds);
    fmt::print("{:>8}  {:<9} {:>6} {:>6} {:>9}  {:<32} {:>7.2f} {:>7.2f}\n", caster_count, row.variant->name,
               row.counters.passes, row.counters.draws, row.counters.instances, to_text(spread, unit),
               spread.median / base.median, spread.median / six.median);
    json.push_back({{"casters", caster_count},
                    {"way", row.variant->name},
                    {"measure", what},
                    {"passes", row.counters.passes},
                    {"draws", row.counters.draws},
                    {"instances", row.counters.instances},
                    {"seconds", to_json(spread)},
                    {"ratio_to_culled", spread.median / base.median},
                    {"ratio_to_six", spread.median / six.median}});
  }
  return json;
}

void bench_shadows(const BenchOptions &options)
{
  nlohmann::json rows = nlohmann::json::array();
  nlohmann::json devices = nlohmann::json::array();
  fmt::print("A point lamp's six faces among casters of {} meshes; median [quartiles] of {} interleaved rounds.\n",
             measure::bench_mesh_count, options.rounds);
  for (const measure::LayerPassVariant &variant : measure::layer_pass_variants()) {
    fmt::print("  {:<9} {}\n", variant.name, variant.description);
  }
  const auto measure = [&](gpu::Device &device, const char *what, measure::Clock clock, double unit,
                           const char *title) {
    fmt::print("\n{}: {}\n", title, device.description());
    fmt::print("{:>8}  {:<9} {:>6} {:>6} {:>9}  {:<32} {:>7} {:>7}\n", "casters", "variant", "passes", "draws",
               "instances", unit == 1e-6 ? "microseconds" : "milliseconds", "/culled", "/six");
    devices.push_back(device.description());
    for (const int caster_count : {10, 1000, 10000}) {
      for (const nlohmann::json &row : print_lamps(
               measure::measure_layer_passes(device, caster_count, options.rounds, clock), caster_count, what, unit)) {
        rows.push_back(row);
      }
    }
  };
  const std::unique_ptr<gpu::Device> null_device = gpu::create_null_device();
  measure(*null_device, "cpu", measure::Clock::ThreadCpu, 1e-6, "Record and submit, CPU time");
  if (options.backend != "null") {
    const std::unique_ptr<gpu::Device> device = create_device(options.backend);
    measure(*device, "wall", measure::Clock::Wall, 1e-3, "Until the device is done, wall time");
  }
  write_json(options.json, {{"program", "gnomon " GNOMON_VERSION},
                            {"bench", "shadows"},
                            {"rounds", options.rounds},
                            {"devices", devices},
                            {"rows", rows}});
}

void bench_left_out(const BenchOptions &options)
{
  const std::unique_ptr<gpu::Device> device = create_device(options.backend);
  const std::vector<measure::LeftOutCost> costs = measure::measure_left_out(*device, options.rounds);
  fmt::print(
      "A full scene and ten that lack one thing each, 640x360, one sample: a first frame with all that it makes,\n"
      "and a warm one; milliseconds, median [quartiles] of {} interleaved rounds, and the ratio of the medians\n"
      "to the full scene's. {}\n\n",
      options.rounds, device->description());
  fmt::print("{:<20} {:>6} {:>5} {:>8} {:>8} {:>8}  {:<30} {:>5}  {:<28} {:>5}\n", "scene", "passes", "draws",
             "programs", "textures", "MiB", "first", "/full", "warm", "/full");
  nlohmann::json json = nlohmann::json::array();
  for (const measure::LeftOutCost &row : costs) {
    const measure::Spread first = measure::spread_of(row.first_seconds);
    const measure::Spread warm = measure::spread_of(row.warm_seconds);
    const double first_ratio = measure::median_ratio(row.first_seconds, costs.front().first_seconds);
    const double warm_ratio = measure::median_ratio(row.warm_seconds, costs.front().warm_seconds);
    const gpu::Counters &c = row.counters;
    fmt::print("{:<20} {:>6} {:>5} {:>8} {:>8} {:>8.1f}  {:<30} {:>5.2f}  {:<28} {:>5.2f}\n", row.name, c.passes,
               c.draws, c.shaders_made, c.textures_made, double(row.memory_bytes) / 0x1p20, to_text(first, 1e-3),
               first_ratio, to_text(warm, 1e-3), warm_ratio);
    json.push_back({{"scene", row.name},
                    {"passes", c.passes},
                    {"draws", c.draws},
                    {"shaders_made", c.shaders_made},
                    {"textures_made", c.textures_made},
                    {"upload_bytes", c.upload_bytes},
                    {"memory_bytes", row.memory_bytes},
                    {"first_seconds", to_json(first)},
                    {"warm_seconds", to_json(warm)},
                    {"first_ratio_to_full", first_ratio},
                    {"warm_ratio_to_full", warm_ratio}});
  }
  write_json(options.json, {{"program", "gnomon " GNOMON_VERSION},
                            {"bench", "left-out"},
                            {"rounds", options.rounds},
                            {"device", device->description()},
                            {"rows", json}});
}

/** Prints a measurement. \a base: that of 8 lamps in the same kind of hall */
nlohmann::json print_lamps(const measure::LampsCost &row, const measure::LampsCost &base)
{
  const measure::Spread lists = measure::spread_of(row.seconds_of_lists);
  const double ratio = measure::median_ratio(row.seconds(), base.seconds());
  nlohmann::json out{{"hall", row.hall},
                     {"lamps", row.lamp_count},
                     {"edge_m", row.edge_m},
                     {"memory_bytes", row.memory_bytes},
                     {"non_finite", row.non_finite_count},
                     {"has_lists", row.has_lists},
                     {"seconds_of_lists", to_json(lists)},
                     {"ratio_to_8", ratio}};
  std::string all_text;
  std::string gain_text;
  if (!row.seconds_of_all.empty()) {
    const measure::Spread all = measure::spread_of(row.seconds_of_all);
    const double gain = measure::median_ratio(row.seconds_of_lists, row.seconds_of_all);
    all_text = to_text(all, 1e-3) + (row.has_lists ? "" : " *");
    gain_text = fmt::format("{:.2f}", gain);
    out["seconds_of_all"] = to_json(all);
    out["lists_to_all"] = gain;
  }
  std::string first_text;
  if (!row.seconds_of_first.empty()) {
    const measure::Spread first = measure::spread_of(row.seconds_of_first);
    first_text = to_text(first, 1e-3);
    out["seconds_of_first"] = to_json(first);
  }
  fmt::print("{:<8} {:>6} {:>7.1f} {:>8.1f}  {:<30}  {:<30} {:>10} {:>6.2f}  {}{}\n", row.hall, row.lamp_count,
             row.edge_m, double(row.memory_bytes) / 0x1p20, to_text(lists, 1e-3) + (row.has_lists ? " *" : ""),
             all_text, gain_text, ratio, first_text, row.non_finite_count > 0 ? "  not finite" : "");
  return out;
}

void bench_lamps(const BenchOptions &options)
{
  const std::unique_ptr<gpu::Device> device = create_device(options.backend);
  const std::vector<measure::LampsCost> costs = measure::measure_lamps(*device, options.rounds);
  fmt::print(
      "Point lamps with a range of {} m and hard shadows in a square hall, 320x180, one sample: warm frames in which\n"
      "pixels visit the lamps that can reach them, by lists, and in which they visit all lamps; milliseconds, median\n"
      "[quartiles] of {} interleaved rounds. *: as the engine draws it; /8: its ratio to 8 lamps in the same kind of "
      "hall.\n"
      "growing: the density of the lamps is that of 128 in 90 m. first: a first frame that "
      "makes\nall resources (*) but programs, which the process has loaded before. {}\n\n",
      measure::bench_lamp_range_m, options.rounds, device->description());
  fmt::print("{:<8} {:>6} {:>7} {:>8}  {:<30}  {:<30} {:>10} {:>6}  {}\n", "hall", "lamps", "edge, m", "MiB", "lists",
             "all lamps", "lists/all", "* /8", "first");
  nlohmann::json json = nlohmann::json::array();
  std::vector<double> counts;
  std::vector<double> medians;
  for (const measure::LampsCost &row : costs) {
    const auto base = std::ranges::find_if(
        costs, [&](const measure::LampsCost &other) { return other.hall == row.hall && other.lamp_count == 8; });
    json.push_back(print_lamps(row, *base));
    if (row.hall == "growing" && row.lamp_count <= 1024) {
      counts.push_back(row.lamp_count);
      medians.push_back(measure::spread_of(row.seconds()).median);
    }
  }
  const double exponent = measure::growth_exponent(counts, medians);
  fmt::print("\nGrowth of a warm frame (*) from 1 to 1024 lamps in the growing hall: exponent {:.2f}\n", exponent);
  write_json(options.json, {{"program", "gnomon " GNOMON_VERSION},
                            {"bench", "lamps"},
                            {"rounds", options.rounds},
                            {"device", device->description()},
                            {"growth_exponent", exponent},
                            {"rows", json}});
}

void bench_edits(const BenchOptions &options)
{
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  fmt::print(
      "Edits of a scene of {} objects and {} lamps: bytes uploaded beyond those of a picture without an edit,\n"
      "lamps whose shadows are drawn, recordings of the passes, and what is made. Counted on the null backend.\n\n",
      measure::edited_object_count, measure::edited_lamp_count);
  fmt::print("{:<40} {:>9} {:>8} {:>11} {:>9} {:>9}\n", "edit", "bytes", "shadows", "recordings", "textures",
             "programs");
  nlohmann::json json = nlohmann::json::array();
  for (const measure::EditCost &cost : measure::edit_costs(*device)) {
    fmt::print("{:<40} {:>9} {:>8} {:>11} {:>9} {:>9}\n", cost.edit, cost.upload_bytes, cost.shadows_drawn,
               cost.pass_recordings, cost.textures_made, cost.shaders_made);
    json.push_back({{"edit", cost.edit},
                    {"upload_bytes", cost.upload_bytes},
                    {"shadows_drawn", cost.shadows_drawn},
                    {"pass_recordings", cost.pass_recordings},
                    {"textures_made", cost.textures_made},
                    {"shaders_made", cost.shaders_made}});
  }
  write_json(options.json, {{"program", "gnomon " GNOMON_VERSION},
                            {"bench", "edits"},
                            {"objects", measure::edited_object_count},
                            {"lamps", measure::edited_lamp_count},
                            {"rows", json}});
}

void bench_start(const BenchOptions &options)
{
  const std::vector<measure::StartCost> costs = measure::measure_start(
      {program_file(), options.scene, arguments_of(options.world), options.backend, options.rounds});
  fmt::print(
      "Whole processes in turn: milliseconds, median [quartiles] of {} rounds, the difference to the first, and the\n"
      "largest memory, which is at least that of this process. render: 640x360, one sample, to an EXR file; backend "
      "{}.\n\n",
      options.rounds, options.backend);
  fmt::print("{:<22}  {:<30} {:>9} {:>8}\n", "process", "from start to end", "-true", "MiB");
  const double base = measure::spread_of(costs.front().seconds).median;
  nlohmann::json json = nlohmann::json::array();
  for (const measure::StartCost &row : costs) {
    const measure::Spread spread = measure::spread_of(row.seconds);
    fmt::print("{:<22}  {:<30} {:>9.1f} {:>8.1f}\n", row.what, to_text(spread, 1e-3), 1e3 * (spread.median - base),
               double(row.peak_bytes) / 0x1p20);
    json.push_back({{"what", row.what}, {"seconds", to_json(spread)}, {"peak_bytes", row.peak_bytes}});
  }
  write_json(options.json, {{"program", "gnomon " GNOMON_VERSION},
                            {"bench", "start"},
                            {"rounds", options.rounds},
                            {"backend", options.backend},
                            {"rows", json}});
}

/** Before minutes of measuring. \throws output::Error where --json cannot be written, or would replace a scene */
void check_files(const BenchOptions &options)
{
  output::Roles roles;
  roles.add_input(options.scene, "the scene");
  for (const std::string &scene : options.scenes) {
    roles.add_input(scene, "the scene");
  }
  roles.add_output(options.json, "--json");
  keep_text_from(roles);
}

}  // namespace

void add_bench(CLI::App &app, Status &status)
{
  CLI::App *command = app.add_subcommand("bench", "Measure the engine's parts on scenes made in place");
  command->require_subcommand(1);
  auto o = std::make_shared<BenchOptions>();
  CLI::App *shadows = command->add_subcommand("shadows", "The methods of drawing a lamp's layers, side by side");
  add_backend_option(*shadows, o->backend, "measure only without a driver");
  shadows->callback([o] { bench_shadows(*o); });
  CLI::App *record = command->add_subcommand("record", "What a draw with its own matrix costs, without a driver");
  record->callback([o] { bench_record(*o); });
  CLI::App *cull = command->add_subcommand("cull", "What the test of boxes against a frustum costs");
  cull->callback([o] { bench_cull(*o); });
  CLI::App *imports = command->add_subcommand("import", "What the import of many nodes costs");
  imports->callback([o] { bench_import(*o); });
  CLI::App *sync = command->add_subcommand("sync", "What edits of lamps among many triangles cost, without a driver");
  sync->callback([o] { bench_sync(*o); });
  CLI::App *left_out =
      command->add_subcommand("left-out", "What scenes that lack one thing each cost, beside a full one");
  add_backend_option(*left_out, o->backend, "without a driver");
  left_out->callback([o] { bench_left_out(*o); });
  CLI::App *lamps = command->add_subcommand("lamps", "What few and many lamps cost in a frame");
  add_backend_option(*lamps, o->backend, "without a driver");
  lamps->callback([o] { bench_lamps(*o); });
  CLI::App *growth =
      command->add_subcommand("growth", "How times grow with objects, casters, imported nodes, pixels and samples");
  add_backend_option(*growth, o->backend, "without pixels and samples");
  for (CLI::App *bench : {cull, imports, growth}) {
    bench->add_option("--count-max", o->count_max, "Leave out larger counts")->check(CLI::Range(1000, 1 << 30));
  }
  growth->callback([o] { bench_growth(*o); });
  CLI::App *start = command->add_subcommand("start", "What starting the program costs, up to a first picture");
  start->add_option("scene", o->scene, "glTF 2.0 file (default: a scene made in place)");
  add_backend_option(*start, o->backend, "without a driver and a picture");
  add_world_options(*start, o->world);
  start->callback([o] { bench_start(*o); });
  for (CLI::App *bench : {shadows, record, cull, imports, sync, left_out, lamps, growth, start}) {
    bench->add_option("--rounds", o->rounds, "Measured rounds, after one that warms up")
        ->capture_default_str()
        ->check(CLI::Range(1, 100000));
    bench->add_option("--json", o->json, "Write the figures, in seconds");
  }
  CLI::App *frames = command->add_subcommand("frames", "Times of a host's frames, one by one, and within a budget");
  frames->add_option("scenes", o->scenes, "glTF 2.0 files")->required();
  frames->add_option("--frames", o->frames, "Measured frames of each kind, after some that warm up")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  frames->add_option("--budget", o->budget_ms, "Time of a draw within a budget, milliseconds")
      ->capture_default_str()
      ->check(number_range(0.1, 10000.0));
  add_backend_option(*frames, o->backend, "without a driver");
  frames->add_option("--json", o->json, "Write the figures, in seconds");
  add_world_options(*frames, o->world);
  frames->callback([o] { bench_frames(*o); });
  CLI::App *memory = command->add_subcommand("memory", "Device memory of a picture, beside that without shadows");
  memory->add_option("scenes", o->scenes, "glTF 2.0 files")->required();
  memory->add_option("--size", o->size, "WIDTHxHEIGHT, pixels")->capture_default_str();
  add_backend_option(*memory, o->backend, "without a driver, and without fits to the picture's depths");
  memory->add_option("--json", o->json, "Write the figures, in bytes");
  add_world_options(*memory, o->world);
  memory->callback([o] { bench_memory(*o); });
  CLI::App *light = command->add_subcommand(
      "light", "Errors of the light of lamps with a size in one frame, against numerical integration");
  light->add_option("--points", o->points, "Points in each of the sets of an integral")
      ->capture_default_str()
      ->check(CLI::Range(1, 1 << 20));
  light->add_option("--json", o->json, "Write the errors");
  light->callback([o, &status] { status = bench_light(*o); });
  CLI::App *edits = command->add_subcommand("edits", "The work that each kind of edit of a large scene causes");
  edits->add_option("--json", o->json, "Write the figures");
  edits->callback([o] { bench_edits(*o); });
  for (CLI::App *bench : command->get_subcommands({})) {
    bench->parse_complete_callback([o] { check_files(*o); });
  }
}

}  // namespace gnomon::cli
