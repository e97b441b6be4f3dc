// SPDX-License-Identifier: MIT
#include "cli.hh"

#include "cli_output.hh"

#include "draw_view_shared.h"
#include "eevee_scene_renderer.hh"
#include "measure_edits.hh"
#include "measure_left_out.hh"
#include "shadows/shadow_cube.hh"
#include "shadows/shadows.hh"

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <fstream>
#include <limits>
#include <numbers>

namespace gnomon::cli {

namespace {

struct BenchOptions {
  std::string backend = "gl";
  int rounds = 21;
  std::string json;
};

/** Of this thread: what other programs do meanwhile is not in it. */
double cpu_seconds()
{
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

double wall_seconds()
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/** Median and quartiles, seconds. */
struct Spread {
  double median = 0.0;
  double low = 0.0;
  double high = 0.0;
};

Spread spread_of(std::vector<double> seconds)
{
  std::ranges::sort(seconds);
  const std::size_t last = seconds.size() - 1;
  return {seconds[last / 2], seconds[last / 4], seconds[last - last / 4]};
}

nlohmann::json to_json(const Spread &spread)
{
  return {{"median", spread.median}, {"low", spread.low}, {"high", spread.high}};
}

std::string to_text(const Spread &spread, double unit)
{
  return fmt::format("{:9.2f} [{:.2f}, {:.2f}]", spread.median / unit, spread.low / unit, spread.high / unit);
}

void write_json(const std::string &path, const nlohmann::json &json)
{
  if (path.empty()) {
    return;
  }
  write_atomically(path, [&](const std::filesystem::path &beside) {
    std::ofstream file(beside);
    file << json.dump(2) << "\n";
    if (!file.flush()) {
      throw std::runtime_error(fmt::format("{}: cannot be written", path));
    }
  });
}

/** A closed column of radius and half height 0.3 m with \a sides sides. */
gpu::Batch column_batch(gpu::Device &device, int sides)
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

constexpr int mesh_count = 8;

std::vector<gpu::Batch> column_batches(gpu::Device &device)
{
  std::vector<gpu::Batch> batches;
  for (int i = 0; i < mesh_count; i++) {
    batches.push_back(column_batch(device, 3 + i));
  }
  return batches;
}

/** How the layers of a lamp are drawn. */
struct Variant {
  const char *name;
  const char *what;
  eevee::LayerPass layer_pass;
  /** Not the engine's: a pass a face, for which the face's view culls the casters one by one. */
  bool is_culled_by_view = false;
};

constexpr std::array<Variant, 4> variants = {{
    {"culled", "a pass a face, each face's view culling all casters (no face masks)", eevee::LayerPass::Single, true},
    {"six", "--cube-pass six: a pass a face, face masks once a lamp", eevee::LayerPass::Single},
    {"geometry", "--cube-pass geometry: one pass, the geometry shader chooses the layer", eevee::LayerPass::Geometry},
    {"layered", "--cube-pass layered: one pass, the vertex shader chooses it", eevee::LayerPass::Layered},
}};

/** Casters on a grid, a metre apart, and a point lamp in their middle, drawn by one variant. */
class LampBench {
 public:
  LampBench(gpu::Device &device, const std::vector<gpu::Batch> &batches, int caster_count, const Variant &variant)
      : device_(device), way_(variant)
  {
    settings_.layer_pass = variant.layer_pass;
    lamp_.name = "lamp";
    lamp_.kind = scene::LampKind::Point;
    add_casters(batches, caster_count);
    prepare(0);
    if (way_.is_culled_by_view) {
      create_faces();
    }
  }

  /** What a change of the scene costs with every variant: the lamp moves, so that all its layers are to be drawn. */
  void prepare(int round)
  {
    lamp_.world_from_lamp[3].x = round % 2 == 0 ? 0.0 : double(1e-3F);
    if (way_.is_culled_by_view) {
      return;
    }
    const std::span<const scene::PlacedLamp> placed(&lamp_, 1);
    eevee::Lamps lamps = eevee::make_lamps(placed);
    scene_shadows_.sync(device_.limits(), eevee::shadow_lamps(placed, lamps), {}, lamps.light_block, settings_);
    scene_shadows_.allocate(device_, shaders_);
    shadows_.allocate(device_);
    for (const eevee::Caster &caster : casters_) {
      scene_shadows_.add_caster(caster);
    }
    scene_shadows_.finish();
  }

  /** What is measured. */
  void draw()
  {
    gpu::CommandList list;
    if (way_.is_culled_by_view) {
      record_faces(list);
    }
    else {
      shadows_.update(device_, view_, 1e-3F, pass_, list);
    }
    device_.submit(list);
    shadows_.submitted();
  }

 private:
  void add_casters(const std::vector<gpu::Batch> &batches, int caster_count)
  {
    using eevee::ShaderId;
    const ShaderId id = way_.layer_pass == eevee::LayerPass::Layered    ? ShaderId::ShadowLayered
                        : way_.layer_pass == eevee::LayerPass::Geometry ? ShaderId::ShadowGeometry
                                                                        : ShaderId::Shadow;
    draw::ShadingGroup &group = pass_.group(shaders_.get(device_, id));
    group.bind_storage_ref("object_block", &object_block_);
    group.bind_uniform_ref("shadow_render_block",
                           way_.is_culled_by_view ? &face_block_ : scene_shadows_.render_block());
    std::vector<draw::InstanceCall *> calls;
    if (!way_.is_culled_by_view) {
      for (const gpu::Batch &batch : batches) {
        calls.push_back(&group.instances(batch));
      }
    }
    const int edge = int(std::ceil(std::cbrt(double(caster_count))));
    for (int i = 0; i < caster_count; i++) {
      // From the middle of each axis; never where the lamp is.
      const glm::vec3 cell(i % edge, i / edge % edge, i / edge / edge);
      const glm::vec3 position = cell - 0.5F * float(edge - 1) + glm::vec3(0.25F, 0.35F, 0.45F);
      const draw::ObjectIndex object = objects_.add(glm::translate(glm::mat4(1.0F), position));
      eevee::Caster &caster = casters_.emplace_back();
      caster.bounds_ws.extend(position - 0.3F);
      caster.bounds_ws.extend(position + 0.3F);
      caster.object = object;
      caster.fingerprint = std::uint64_t(i);
      // Those of one mesh stand together, so that culled calls of it make one draw as well.
      const auto mesh = std::size_t(std::int64_t(i) * mesh_count / caster_count);
      if (way_.is_culled_by_view) {
        group.call(batches[mesh], object, {position, caster.bounds_ws.radius()});
      }
      else {
        caster.instances = calls[mesh];
      }
    }
    objects_.upload(device_);
    object_block_ = {objects_.buffer().id()};
    // Sees all, so that no face is skipped.
    const float reach = 2.0F * float(edge);
    view_ = draw::View(glm::translate(glm::mat4(1.0F), glm::vec3(0, 0, -reach)),
                       draw::orthographic(reach, reach, 0.0F, 2.0F * reach));
  }

  void create_faces()
  {
    faces_ = device_.create_texture({.name = "faces",
                                     .kind = gpu::TextureKind::Array,
                                     .format = gpu::Format::Depth32F,
                                     .width = settings_.cube_size_px,
                                     .height = settings_.cube_size_px,
                                     .layers = 6});
    for (int face = 0; face < 6; face++) {
      framebuffers_.push_back(
          device_.create_framebuffer({.name = "face", .colors = {}, .depth = {.texture = &faces_, .layer = face}}));
    }
    const std::uint32_t alignment = device_.limits().uniform_offset_alignment;
    stride_ = (std::uint32_t(sizeof(shared::ShadowRenderBlock)) + alignment - 1) / alignment * alignment;
    face_blocks_ = device_.create_buffer({"face_blocks", gpu::BufferKind::Storage, std::size_t(6) * stride_});
  }

  void record_faces(gpu::CommandList &list)
  {
    const glm::vec3 position_ws(lamp_.world_from_lamp[3]);
    const auto views = eevee::shadow_cube_views(position_ws, 0.05F, settings_.cube_size_px);
    for (std::uint32_t face = 0; face < 6; face++) {
      face_block_ = {face_blocks_.id(), face * stride_, sizeof(shared::ShadowRenderBlock)};
      const glm::mat4 &clip_from_world = views[face].clip_from_world();
      list.update(face_blocks_, face_block_.offset_bytes, std::as_bytes(std::span(&clip_from_world, 1)));
      list.begin_pass("face", framebuffers_[face], {});
      pass_.record(views[face], list);
      list.end_pass();
    }
  }

  gpu::Device &device_;
  const Variant &way_;
  eevee::ShadowSettings settings_;
  scene::PlacedLamp lamp_;
  eevee::ShaderCache shaders_;
  eevee::SceneShadows scene_shadows_;
  eevee::Shadows shadows_{scene_shadows_};
  draw::ObjectBuffer objects_;
  gpu::BufferRange object_block_;
  // As the engine's.
  draw::Pass pass_{"shadow_pass", gpu::State::WriteDepth | gpu::State::DepthNearerEqual | gpu::State::DepthClamp};
  draw::View view_;
  std::vector<eevee::Caster> casters_;
  gpu::Texture faces_;
  std::vector<gpu::Framebuffer> framebuffers_;
  gpu::Buffer face_blocks_;
  gpu::BufferRange face_block_;
  std::uint32_t stride_ = 0;
};

/** A row of the table. */
struct LampRow {
  const Variant *variant = nullptr;
  gpu::Counters counters;
  std::vector<double> seconds;
};

/** The variants side by side: each round draws each of them once. */
std::vector<LampRow> measure_lamps(gpu::Device &device, int caster_count, int rounds, double (*clock)())
{
  const std::vector<gpu::Batch> batches = column_batches(device);
  std::vector<std::unique_ptr<LampBench>> benches;
  std::vector<LampRow> rows;
  for (const Variant &variant : variants) {
    if (variant.layer_pass != eevee::LayerPass::Layered || device.limits().has_vertex_layer) {
      benches.push_back(std::make_unique<LampBench>(device, batches, caster_count, variant));
      rows.push_back({&variant, {}, {}});
    }
  }
  // The first warms up.
  for (int round = 0; round <= rounds; round++) {
    for (std::size_t i = 0; i < rows.size(); i++) {
      benches[i]->prepare(round + 1);
      device.finish();
      const gpu::Counters before = device.counters();
      const double start = clock();
      benches[i]->draw();
      device.finish();
      if (round > 0) {
        rows[i].seconds.push_back(clock() - start);
      }
      const gpu::Counters &now = device.counters();
      rows[i].counters.passes = now.passes - before.passes;
      rows[i].counters.draws = now.draws - before.draws;
      rows[i].counters.instances = now.instances - before.instances;
    }
  }
  return rows;
}

/** Rows of one measurement beside the first of them. */
nlohmann::json print_lamps(const std::vector<LampRow> &rows, int caster_count, const char *what, double unit)
{
  nlohmann::json json = nlohmann::json::array();
  const Spread base = spread_of(rows[0].seconds);
  const Spread six = spread_of(rows[1].seconds);
  for (const LampRow &row : rows) {
    const Spread spread = spread_of(row.seconds);
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
             mesh_count, options.rounds);
  for (const Variant &variant : variants) {
    fmt::print("  {:<9} {}\n", variant.name, variant.what);
  }
  const auto measure = [&](gpu::Device &device, const char *what, double (*clock)(), double unit, const char *title) {
    fmt::print("\n{}: {}\n", title, device.description());
    fmt::print("{:>8}  {:<9} {:>6} {:>6} {:>9}  {:<32} {:>7} {:>7}\n", "casters", "variant", "passes", "draws",
               "instances", unit == 1e-6 ? "microseconds" : "milliseconds", "/culled", "/six");
    devices.push_back(device.description());
    for (const int caster_count : {10, 1000, 10000}) {
      for (const nlohmann::json &row :
           print_lamps(measure_lamps(device, caster_count, options.rounds, clock), caster_count, what, unit)) {
        rows.push_back(row);
      }
    }
  };
  const std::unique_ptr<gpu::Device> null_device = gpu::create_null_device();
  measure(*null_device, "cpu", cpu_seconds, 1e-6, "Record and submit, CPU time");
  if (options.backend == "gl") {
    const std::unique_ptr<gpu::Device> gl_device =
        gpu::create_gl_device({.shader_cache_folder = gpu::default_shader_cache_folder()});
    measure(*gl_device, "wall", wall_seconds, 1e-3, "Until the device is done, wall time");
  }
  write_json(options.json, {{"program", "gnomon " GNOMON_VERSION},
                            {"bench", "shadows"},
                            {"rounds", options.rounds},
                            {"devices", devices},
                            {"rows", rows}});
}

/** Draws that share nothing but their group: each has a matrix of its own, and another mesh than the one before. */
void bench_draws(const BenchOptions &options)
{
  constexpr int draw_count = 10000;
  const std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  const std::vector<gpu::Batch> batches = column_batches(*device);
  const gpu::Texture texture = device->create_texture({.name = "depth", .format = gpu::Format::Depth32F});
  const gpu::Framebuffer framebuffer =
      device->create_framebuffer({.name = "depth", .colors = {}, .depth = {.texture = &texture}});
  eevee::ShaderCache shaders;
  const gpu::Shader &shader = shaders.get(*device, eevee::ShaderId::Depth);
  std::vector<glm::mat4> matrices;
  for (int i = 0; i < draw_count; i++) {
    const glm::vec3 axis(1.0F, float(i % 7), float(i % 3));
    matrices.push_back(glm::rotate(glm::translate(glm::mat4(1.0F), glm::vec3(i % 100, i / 100, 0)), float(i), axis));
  }
  const gpu::Buffer view_block =
      device->create_buffer({"view_block", gpu::BufferKind::Uniform, sizeof(shared::ViewData)});
  draw::ObjectBuffer objects;
  gpu::BufferRange object_block;
  draw::Pass pass("depth_pass", gpu::State::WriteDepth, &objects);
  const draw::View view;
  std::array<std::vector<double>, 3> seconds;
  for (int round = 0; round <= options.rounds; round++) {
    for (draw::ObjectIndex i = objects.index_end() - 1; i > draw::object_identity; i--) {
      objects.remove(i);
    }
    const double start = cpu_seconds();
    pass.clear();
    draw::ShadingGroup &group = pass.group(shader);
    group.bind_uniform("view_block", view_block);
    group.bind_storage_ref("object_block", &object_block);
    for (std::size_t i = 0; i < draw_count; i++) {
      group.call(batches[i % mesh_count], matrices[i]);
    }
    objects.upload(*device);
    object_block = {objects.buffer().id()};
    const double called = cpu_seconds();
    gpu::CommandList list;
    list.begin_pass("depth_prepass", framebuffer, {});
    pass.record(view, list);
    list.end_pass();
    device->submit(list);
    const double submitted = cpu_seconds();
    // The first warms up.
    if (round > 0) {
      seconds[0].push_back((called - start) / draw_count);
      seconds[1].push_back((submitted - called) / draw_count);
      seconds[2].push_back((submitted - start) / draw_count);
    }
  }
  fmt::print("{} draws, each with a matrix of its own; CPU nanoseconds a draw, median [quartiles] of {} rounds; {}\n",
             draw_count, options.rounds, device->description());
  nlohmann::json rows = nlohmann::json::array();
  const std::array<const char *, 3> names = {"recorded in a pass", "pass drawn for a view", "both"};
  for (std::size_t i = 0; i < names.size(); i++) {
    const Spread spread = spread_of(seconds[i]);
    fmt::print("  {:<22} {}\n", names[i], to_text(spread, 1e-9));
    rows.push_back({{"what", names[i]}, {"seconds_a_draw", to_json(spread)}});
  }
  write_json(options.json, {{"program", "gnomon " GNOMON_VERSION},
                            {"bench", "draws"},
                            {"rounds", options.rounds},
                            {"draws", draw_count},
                            {"rows", rows}});
}

/** One of the scenes, and what its frames cost. */
struct LeftOutRow {
  measure::LeftOutCase of;
  gpu::Counters counters;
  std::size_t memory_bytes = 0;
  /** From a sync to the last pixel, everything made anew; and of the next frame, which finds all up to date. */
  std::vector<double> first_seconds;
  std::vector<double> warm_seconds;
};

/** A first and a warm frame, added to \a row unless it is to warm up. */
void draw_left_out(gpu::Device &device, LeftOutRow &row, bool is_warm_up)
{
  constexpr glm::ivec2 size_px(640, 360);
  const gpu::Counters before = device.counters();
  const double start = wall_seconds();
  eevee::SceneRenderer renderer(device, row.of.scene, size_px, row.of.settings);
  const scene::PlacedCamera camera = row.of.scene.placed_cameras().front();
  renderer.sync();
  renderer.draw(camera);
  device.finish();
  const double first_end = wall_seconds();
  const gpu::Counters &now = device.counters();
  row.counters.passes = now.passes - before.passes;
  row.counters.draws = now.draws - before.draws;
  row.counters.shaders_made = now.shaders_made - before.shaders_made;
  row.counters.textures_made = now.textures_made - before.textures_made;
  row.counters.upload_bytes = now.upload_bytes - before.upload_bytes;
  row.memory_bytes = device.memory_bytes();
  // The best of a few: other programs' work only adds.
  double warm = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5; i++) {
    const double warm_start = wall_seconds();
    renderer.draw(camera);
    device.finish();
    warm = std::min(warm, wall_seconds() - warm_start);
  }
  if (!is_warm_up) {
    row.first_seconds.push_back(first_end - start);
    row.warm_seconds.push_back(warm);
  }
}

/** Median of the rounds' ratios: what slows one round down slows both. */
double ratio_to(const std::vector<double> &seconds, const std::vector<double> &base)
{
  std::vector<double> ratios;
  for (std::size_t i = 0; i < seconds.size(); i++) {
    ratios.push_back(seconds[i] / base[i]);
  }
  return spread_of(ratios).median;
}

void bench_left_out(const BenchOptions &options)
{
  const std::unique_ptr<gpu::Device> device =
      options.backend == "gl" ? gpu::create_gl_device({.shader_cache_folder = gpu::default_shader_cache_folder()})
                              : gpu::create_null_device();
  std::vector<LeftOutRow> rows;
  for (measure::LeftOutCase &of : measure::left_out_cases()) {
    rows.push_back({std::move(of), {}, 0, {}, {}});
  }
  for (int round = 0; round <= options.rounds; round++) {
    for (LeftOutRow &row : rows) {
      draw_left_out(*device, row, round == 0);
    }
  }
  fmt::print(
      "A full scene and ten that lack one thing each, 640x360, one sample: a first frame with all that it makes,\n"
      "and a warm one; milliseconds, median [quartiles] of {} interleaved rounds, and the ratio of the medians\n"
      "to the full scene's. {}\n\n",
      options.rounds, device->description());
  fmt::print("{:<20} {:>6} {:>5} {:>8} {:>8} {:>8}  {:<30} {:>5}  {:<28} {:>5}\n", "scene", "passes", "draws",
             "programs", "textures", "MiB", "first", "/full", "warm", "/full");
  nlohmann::json json = nlohmann::json::array();
  for (const LeftOutRow &row : rows) {
    const Spread first = spread_of(row.first_seconds);
    const Spread warm = spread_of(row.warm_seconds);
    const double first_ratio = ratio_to(row.first_seconds, rows.front().first_seconds);
    const double warm_ratio = ratio_to(row.warm_seconds, rows.front().warm_seconds);
    const gpu::Counters &c = row.counters;
    fmt::print("{:<20} {:>6} {:>5} {:>8} {:>8} {:>8.1f}  {:<30} {:>5.2f}  {:<28} {:>5.2f}\n", row.of.name, c.passes,
               c.draws, c.shaders_made, c.textures_made, double(row.memory_bytes) / 0x1p20, to_text(first, 1e-3),
               first_ratio, to_text(warm, 1e-3), warm_ratio);
    json.push_back({{"scene", row.of.name},
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

}  // namespace

void add_bench(CLI::App &app)
{
  CLI::App *command = app.add_subcommand("bench", "Measure the engine's parts on scenes made in place");
  command->require_subcommand(1);
  auto o = std::make_shared<BenchOptions>();
  CLI::App *shadows = command->add_subcommand("shadows", "The methods of drawing a lamp's layers, side by side");
  shadows->add_option("--backend", o->backend, "gl: on the null backend and on the driver; null: without a driver")
      ->capture_default_str()
      ->check(CLI::IsMember({"gl", "null"}));
  shadows->callback([o] { bench_shadows(*o); });
  CLI::App *draws = command->add_subcommand("draws", "What a draw with its own matrix costs, without a driver");
  draws->callback([o] { bench_draws(*o); });
  CLI::App *left_out =
      command->add_subcommand("left-out", "What scenes that lack one thing each cost, beside a full one");
  left_out->add_option("--backend", o->backend, "gl, or null: without a driver")
      ->capture_default_str()
      ->check(CLI::IsMember({"gl", "null"}));
  left_out->callback([o] { bench_left_out(*o); });
  for (CLI::App *bench : {shadows, draws, left_out}) {
    bench->add_option("--rounds", o->rounds, "Measured rounds, after one that warms up")
        ->capture_default_str()
        ->check(CLI::Range(1, 100000));
    bench->add_option("--json", o->json, "Write the figures, in seconds");
  }
  CLI::App *edits = command->add_subcommand("edits", "The work that each kind of edit of a large scene causes");
  edits->add_option("--json", o->json, "Write the figures");
  edits->callback([o] { bench_edits(*o); });
}

}  // namespace gnomon::cli
