// SPDX-License-Identifier: MIT
#include "cli.hh"

#include "cli_output.hh"

#include "eevee_camera.hh"
#include "eevee_engine.hh"
#include "reference_compare.hh"
#include "scene_gltf.hh"

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

struct ReportOptions {
  std::vector<std::string> scenes;
  std::string folder;
  std::vector<int> size = {640, 360};
  int rounds = 3;
};

/** One way of making shadows. */
struct Technique {
  std::string name;
  /** Of the layers that are looked up. */
  int size_px = 0;
  eevee::ShadowSettings settings;
};

/** A technique on a scene: what it costs, and how wrong it is. */
struct Cell {
  Technique technique;
  /** One entry a round. */
  std::vector<double> shadow_seconds;
  std::vector<double> frame_seconds;
  /** Over all lamps. */
  reference::VisibilityError error;
  std::vector<std::string> limits;
};

struct SceneReport {
  std::string scene;
  std::vector<Cell> cells;
};

std::vector<Technique> techniques()
{
  std::vector<Technique> all;
  const auto add_maps = [&](const std::string &name, scene::ShadowKind kind, const eevee::PcfKernel &pcf) {
    for (const int size_px : {512, 1024, 2048, 4096}) {
      eevee::ShadowSettings settings;
      settings.kind = kind;
      settings.pcf = pcf;
      settings.cube_size_px = size_px;
      settings.map_size_px = size_px;
      // One map, so that only its size changes from cell to cell.
      settings.cascades.count = 1;
      settings.memory_bytes_max = std::size_t(4) << 30U;
      all.push_back({name, size_px, settings});
    }
  };
  add_maps("hard", scene::ShadowKind::Hard, {});
  add_maps("pcf 3x3", scene::ShadowKind::Pcf, {.width = 3, .taps = 0});
  add_maps("pcf 5x5", scene::ShadowKind::Pcf, {.width = 5, .taps = 0});
  add_maps("pcf disk:16", scene::ShadowKind::Pcf, {.width = 0, .taps = 16});
  const auto add_esm = [&](const std::string &name, scene::ShadowKind kind, eevee::EsmKernel kernel) {
    for (const int size_px : {256, 512, 1024}) {
      eevee::ShadowSettings settings;
      settings.kind = kind;
      settings.esm.kernel = kernel;
      settings.esm.size_px = size_px;
      all.push_back({name, size_px, settings});
    }
  };
  add_esm("esm 4", scene::ShadowKind::Esm, eevee::EsmKernel::Disk4);
  add_esm("esm 32", scene::ShadowKind::Esm, eevee::EsmKernel::Disk32);
  add_esm("esm separable", scene::ShadowKind::Esm, eevee::EsmKernel::Separable);
  add_esm("evsm 4", scene::ShadowKind::Evsm, eevee::EsmKernel::Disk4);
  return all;
}

double median(std::vector<double> values)
{
  if (values.empty()) {
    return 0.0;
  }
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/** Of all lamps as of one. Edge offsets: the worst lamp's. */
void add_error(reference::VisibilityError &sum, const reference::VisibilityError &one)
{
  const std::size_t facing = sum.facing_count + one.facing_count;
  if (facing > 0) {
    sum.mean_absolute_error =
        (sum.mean_absolute_error * double(sum.facing_count) + one.mean_absolute_error * double(one.facing_count)) /
        double(facing);
  }
  sum.receiver_count += one.receiver_count;
  sum.off_surface_count += one.off_surface_count;
  sum.facing_count = facing;
  sum.non_finite_count += one.non_finite_count;
  sum.wrong_count += one.wrong_count;
  sum.leak_count += one.leak_count;
  sum.acne_count += one.acne_count;
  sum.edge_count += one.edge_count;
  sum.wrong_fraction = facing > 0 ? double(sum.wrong_count) / double(facing) : 0.0;
  sum.edge_offset_median = std::max(sum.edge_offset_median, one.edge_offset_median);
  sum.edge_offset_p95 = std::max(sum.edge_offset_p95, one.edge_offset_p95);
  sum.edge_offset_max = std::max(sum.edge_offset_max, one.edge_offset_max);
}

/** Planes seen by a lamp at less than half a degree get less than 1 % of its light, and are not judged. */
constexpr double judged_cosine_min = 0.0087;

/** Whether \a lamp shines there: within a spot's cone and the range, and not along the surface. */
bool is_lit_at(const scene::Lamp &lamp, const glm::dvec3 &position_ws, const glm::dvec3 &normal_ws)
{
  const glm::dvec3 back_ws(lamp.world_from_lamp[2]);
  if (lamp.kind == scene::LampKind::Sun) {
    return glm::dot(back_ws, normal_ws) > judged_cosine_min;
  }
  const glm::dvec3 to_lamp = glm::dvec3(lamp.world_from_lamp[3]) - position_ws;
  const double distance = glm::length(to_lamp);
  const bool is_in_range = lamp.range == 0.0F || distance < double(lamp.range);
  const bool is_in_cone = lamp.kind != scene::LampKind::Spot ||
                          glm::dot(to_lamp, back_ws) > distance * std::cos(double(lamp.spot_outer_angle));
  return is_in_range && is_in_cone && glm::dot(to_lamp, normal_ws) > judged_cosine_min * distance;
}

reference::VisibilityError judge(const scene::Scene &scene, const reference::Tracer &tracer, eevee::Engine &engine,
                                 draw::Viewport &viewport, const draw::View &view)
{
  reference::VisibilityError all;
  for (std::size_t lamp = 0; lamp < scene.lamps.size(); lamp++) {
    const std::optional<eevee::Probe> probe = engine.probe(viewport, view, lamp);
    if (!probe) {
      continue;
    }
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<float> visibility;
    for (std::size_t i = 0; i < probe->normal.size(); i++) {
      if (probe->normal[i].w > 0.0F &&
          is_lit_at(scene.lamps[lamp], glm::dvec3(probe->position_visibility[i]), glm::dvec3(probe->normal[i]))) {
        positions.emplace_back(probe->position_visibility[i]);
        normals.emplace_back(probe->normal[i]);
        visibility.push_back(probe->position_visibility[i].w);
      }
    }
    reference::CompareSettings settings;
    settings.texel_size_m = [&](const glm::dvec3 &position_ws) {
      return engine.shadow_texel_size(viewport, lamp, position_ws);
    };
    add_error(all,
              reference::compare_visibility(tracer, scene.lamps[lamp], {positions, normals, visibility}, settings));
  }
  return all;
}

/** Draw \a cell's first and second picture, and judge the shadows in the first round. */
void run_round(const scene::Scene &scene, const reference::Tracer &tracer, gpu::Device &device,
               const ReportOptions &options, bool is_first, Cell &cell)
{
  eevee::Settings settings;
  settings.shadow = cell.technique.settings;
  settings.is_timed = true;
  settings.has_probe = is_first;
  eevee::Engine engine(scene, settings);
  draw::Viewport viewport(device, {options.size[0], options.size[1]});
  const std::array<draw::Engine *, 1> engines = {&engine};
  viewport.sync(engines, eevee::object_refs(scene));
  const draw::View view = eevee::view_of(scene.cameras.front(), viewport.size_px());
  viewport.draw(engines, view);
  for (const eevee::StepTime &step : engine.take_step_times(viewport)) {
    if (step.step == "shadows") {
      cell.shadow_seconds.push_back(step.seconds);
    }
  }
  device.finish();
  const Clock::time_point start = Clock::now();
  viewport.draw(engines, view);
  device.finish();
  cell.frame_seconds.push_back(std::chrono::duration<double>(Clock::now() - start).count());
  if (is_first) {
    cell.error = judge(scene, tracer, engine, viewport, view);
    cell.limits = engine.report(viewport).limits;
  }
}

SceneReport measure(const std::string &path, gpu::Device &device, const ReportOptions &options)
{
  scene::Scene scene = scene::import_gltf(path);
  for (scene::Lamp &lamp : scene.lamps) {
    // The technique decides; a lamp that asks for no shadow keeps its word.
    if (lamp.shadow.kind != scene::ShadowKind::None) {
      lamp.shadow = {};
    }
  }
  const reference::Tracer tracer(scene);
  SceneReport report;
  report.scene = fs::path(path).stem().string();
  for (const Technique &technique : techniques()) {
    report.cells.push_back(
        {.technique = technique, .shadow_seconds = {}, .frame_seconds = {}, .error = {}, .limits = {}});
  }
  const int count = options.rounds * int(report.cells.size());
  int done = 0;
  for (int round = 0; round < options.rounds; round++) {
    for (Cell &cell : report.cells) {
      run_round(scene, tracer, device, options, round == 0, cell);
      done++;
      if (isatty(STDERR_FILENO)) {
        fmt::print(stderr, "\r{}: {}/{} cells{}", report.scene, done, count, done == count ? "\r\033[K" : "");
      }
    }
  }
  return report;
}

/** p in wrong ∝ size^-p, by least squares over the cells of one technique; nothing where any has no error. */
std::optional<double> convergence_order(const std::vector<Cell> &cells, const std::string &technique)
{
  double n = 0.0;
  double sx = 0.0;
  double sy = 0.0;
  double sxx = 0.0;
  double sxy = 0.0;
  for (const Cell &cell : cells) {
    if (cell.technique.name != technique) {
      continue;
    }
    if (cell.error.wrong_count == 0) {
      return std::nullopt;
    }
    const double x = std::log(double(cell.technique.size_px));
    const double y = std::log(cell.error.wrong_fraction);
    n += 1.0;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  return n > 1.0 ? std::optional(-(n * sxy - sx * sy) / (n * sxx - sx * sx)) : std::nullopt;
}

std::vector<std::string> technique_names(const SceneReport &report)
{
  std::vector<std::string> names;
  for (const Cell &cell : report.cells) {
    if (names.empty() || names.back() != cell.technique.name) {
      names.push_back(cell.technique.name);
    }
  }
  return names;
}

constexpr std::string_view csv_header =
    "scene,technique,size_px,shadow_seconds,frame_seconds,facing,wrong,wrong_fraction,mean_absolute_error,leak,acne,"
    "edge_offset_median,edge_offset_p95,edge_offset_max,non_finite,off_surface\n";

std::string csv_line(const std::string &scene, const Cell &cell)
{
  const reference::VisibilityError &e = cell.error;
  return fmt::format("{},{},{},{:.6f},{:.6f},{},{},{:.8f},{:.8f},{},{},{},{},{},{},{}\n", scene, cell.technique.name,
                     cell.technique.size_px, median(cell.shadow_seconds), median(cell.frame_seconds), e.facing_count,
                     e.wrong_count, e.wrong_fraction, e.mean_absolute_error, e.leak_count, e.acne_count,
                     e.edge_offset_median, e.edge_offset_p95, e.edge_offset_max, e.non_finite_count,
                     e.off_surface_count);
}

nlohmann::json to_json(const SceneReport &report)
{
  nlohmann::json cells = nlohmann::json::array();
  for (const Cell &cell : report.cells) {
    const reference::VisibilityError &e = cell.error;
    cells.push_back({{"technique", cell.technique.name},
                     {"size_px", cell.technique.size_px},
                     {"shadow_seconds", cell.shadow_seconds},
                     {"frame_seconds", cell.frame_seconds},
                     {"facing", e.facing_count},
                     {"wrong", e.wrong_count},
                     {"wrong_fraction", e.wrong_fraction},
                     {"mean_absolute_error", e.mean_absolute_error},
                     {"leak", e.leak_count},
                     {"acne", e.acne_count},
                     {"edge_offset_median", e.edge_offset_median},
                     {"edge_offset_p95", e.edge_offset_p95},
                     {"edge_offset_max", e.edge_offset_max},
                     {"non_finite", e.non_finite_count},
                     {"off_surface", e.off_surface_count},
                     {"limits", cell.limits}});
  }
  nlohmann::json orders = nlohmann::json::object();
  for (const std::string &name : technique_names(report)) {
    const std::optional<double> order = convergence_order(report.cells, name);
    orders[name] = order ? nlohmann::json(*order) : nlohmann::json();
  }
  return {{"scene", report.scene}, {"cells", cells}, {"convergence_order", orders}};
}

void print(const SceneReport &report)
{
  fmt::print("\n{}\n{:14} {:>5} {:>10} {:>9} {:>8} {:>8} {:>6} {:>6}  {}\n", report.scene, "technique", "size",
             "shadows ms", "frame ms", "wrong %", "error %", "leak", "acne", "edge offset, texels: median, 95 %, most");
  for (const Cell &cell : report.cells) {
    const reference::VisibilityError &e = cell.error;
    fmt::print("{:14} {:5} {:10.1f} {:9.1f} {:8.4f} {:8.4f} {:6} {:6}  {} {} {}\n", cell.technique.name,
               cell.technique.size_px, 1e3 * median(cell.shadow_seconds), 1e3 * median(cell.frame_seconds),
               100.0 * e.wrong_fraction, 100.0 * e.mean_absolute_error, e.leak_count, e.acne_count,
               e.edge_offset_median, e.edge_offset_p95, e.edge_offset_max);
  }
  for (const Cell &cell : report.cells) {
    for (const std::string &limit : cell.limits) {
      fmt::print(stderr, "gnomon: limit: {}, {} {}: {}\n", report.scene, cell.technique.name, cell.technique.size_px,
                 limit);
    }
  }
  fmt::print("wrong pixels fall as size to the power of");
  for (const std::string &name : technique_names(report)) {
    const std::optional<double> order = convergence_order(report.cells, name);
    fmt::print(" {} {}", name, order ? fmt::format("{:.2f};", -*order) : "(none wrong);");
  }
  fmt::print("\n");
}

Status report(const ReportOptions &options)
{
  fs::create_directories(options.folder);
  const std::unique_ptr<gpu::Device> device =
      gpu::create_gl_device({.shader_cache_folder = gpu::default_shader_cache_folder()});
  fmt::print("{}\n", device->description());
  std::string csv(csv_header);
  nlohmann::json json = {{"program", "gnomon " GNOMON_VERSION},
                         {"device", device->description()},
                         {"size", options.size},
                         {"rounds", options.rounds},
                         {"scenes", nlohmann::json::array()}};
  std::size_t non_finite = 0;
  for (const std::string &path : options.scenes) {
    const SceneReport scene = measure(path, *device, options);
    print(scene);
    for (const Cell &cell : scene.cells) {
      csv += csv_line(scene.scene, cell);
      non_finite += cell.error.non_finite_count;
    }
    json["scenes"].push_back(to_json(scene));
    // After each scene, so that an interrupted run has left what it had.
    write_text(fs::path(options.folder) / "report.csv", csv);
    write_text(fs::path(options.folder) / "report.json", json.dump(2) + "\n");
  }
  return non_finite > 0 ? Status::NonFinite : Status::Done;
}

}  // namespace

void add_report(CLI::App &app, Status &status)
{
  auto o = std::make_shared<ReportOptions>();
  CLI::App *command = app.add_subcommand("report", "Time of each shadow method, and its error against exact rays");
  command->add_option("scenes", o->scenes, "glTF 2.0 files")->required();
  command->add_option("-o,--output", o->folder, "Folder for report.csv and report.json")->required();
  command->add_option("--size", o->size, "Width and height of the picture, pixels")
      ->delimiter('x')
      ->expected(2)
      ->check(CLI::Range(1, 16384));
  command->add_option("--rounds", o->rounds, "Rounds over all methods; times are the medians")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->callback([o, &status] { status = report(*o); });
}

}  // namespace gnomon::cli
