// SPDX-License-Identifier: MIT
#include "cli.hh"

#include "cli_choice.hh"
#include "cli_debug.hh"
#include "cli_explain.hh"
#include "cli_frames.hh"
#include "cli_output.hh"
#include "cli_picture.hh"
#include "cli_world.hh"

#include "eevee_scene_renderer.hh"
#include "gltf_import.hh"
#include "gpu_read.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <unistd.h>
#include <charconv>
#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start)
{
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/** Values of `--view`. */
const std::map<std::string, draw::ViewTransform> view_transforms = {{"standard", draw::ViewTransform::Standard},
                                                                    {"raw", draw::ViewTransform::Raw},
                                                                    {"agx", draw::ViewTransform::Agx},
                                                                    {"pbr-neutral", draw::ViewTransform::PbrNeutral}};

struct RenderOptions {
  std::string scene;
  std::string output;
  std::string size = "960x540";
  std::string camera;
  int samples = 16;
  /** Seconds for each picture; infinity without --time-limit, otherwise `samples` may be 0: no limit. */
  double seconds_max = std::numeric_limits<double>::infinity();
  FrameOptions frames;
  int repeat = 1;
  std::string shadow = "hard";
  int shadow_size = 0;
  std::string pcf = "3x3";
  std::string esm = "4";
  int cascades = 0;
  float cascade_lambda = eevee::CascadeSettings().lambda;
  std::string cascade_range = "view";
  std::string cube_pass = "best";
  std::string casters = "all";
  int shadow_memory = 1024;
  std::string debug;
  DebugView debug_view;
  std::string aov;
  std::string view = "pbr-neutral";
  float exposure = 0.0F;
  std::string backend = "gl";
  bool is_explained = false;
  std::string json;
  ChoiceOptions choice;
  bool is_strict = false;
  std::uint32_t seed = 0;
  WorldOptions world;
};

/** Measurements for the printed summary and for --json. */
struct RenderResult {
  std::string device;
  /** Of the last picture. */
  int samples_drawn = 0;
  double import_seconds = 0.0;
  double device_seconds = 0.0;
  double sync_seconds = 0.0;
  std::vector<double> frame_seconds;
  std::vector<std::vector<eevee::StepTime>> frame_steps;
  std::vector<eevee::ShadowCounters> frame_shadows;
  /** Number of frames that --resume skipped. */
  int skipped_frame_count = 0;
  double output_seconds = 0.0;
  double total_seconds = 0.0;
  std::size_t non_finite_count = 0;
  gpu::Counters counters;
  /** Device memory of all resources at the end. */
  std::size_t memory_bytes = 0;
  eevee::Report report;
};

glm::ivec2 parse_size(const std::string &text)
{
  glm::ivec2 size{0};
  const char *end = text.data() + text.size();
  const auto [after_width, width_error] = std::from_chars(text.data(), end, size.x);
  const bool has_x = width_error == std::errc() && after_width != end && *after_width == 'x';
  const auto [after_height, height_error] = std::from_chars(has_x ? after_width + 1 : end, end, size.y);
  if (!has_x || height_error != std::errc() || after_height != end || size.x < 1 || size.y < 1) {
    throw UsageError(fmt::format("--size '{}' is not WIDTHxHEIGHT in pixels", text));
  }
  return size;
}

bool is_png(const fs::path &path)
{
  return path.extension() == ".png";
}

void check_options(const RenderOptions &options)
{
  const auto unbuilt = [](const std::string &what) { throw UsageError(what + " is not built yet"); };
  if (!options.aov.empty()) {
    unbuilt("--aov");
  }
  if (!std::isfinite(options.exposure)) {
    throw UsageError(fmt::format("--exposure {} is not a number of stops", options.exposure));
  }
  if (!std::isfinite(options.cascade_lambda)) {
    throw UsageError(fmt::format("--cascade-lambda {} is not from 0 to 1", options.cascade_lambda));
  }
  if (options.choice.is_asked() && options.backend != "gl") {
    throw UsageError("--max-error and --max-time measure a rendered picture and need --backend gl");
  }
  if (!options.choice.report_folder.empty() && !options.choice.is_asked()) {
    throw UsageError("--report needs --max-error or --max-time");
  }
  if (options.output.empty() && options.backend == "gl") {
    throw UsageError("-o OUT.exr or -o OUT.png is required");
  }
  const fs::path output = options.output;
  if (!options.output.empty() && !is_png(output) && output.extension() != ".exr") {
    throw UsageError(fmt::format("-o '{}' ends in neither .exr nor .png", options.output));
  }
}

/** Checks that \a path can be written, before the program renders. */
void check_folder(const fs::path &path)
{
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!path.empty() && (!fs::is_directory(folder) || access(folder.c_str(), W_OK) != 0)) {
    throw std::runtime_error(fmt::format("{}: the folder does not exist or cannot be written to", path.string()));
  }
}

scene::PlacedCamera find_camera(const scene::Scene &scene, const std::string &name)
{
  std::vector<std::string> names;
  for (const scene::PlacedCamera &camera : scene.placed_cameras()) {
    if (name.empty() || camera.name == name) {
      return camera;
    }
    names.push_back(camera.name);
  }
  throw std::runtime_error(fmt::format("{}: no camera '{}'; it has: {}", scene.path, name, fmt::join(names, ", ")));
}

eevee::PcfKernel parse_pcf(const std::string &text)
{
  if (text == "1" || text == "3x3" || text == "5x5") {
    return {.width = text[0] - '0', .taps = 0};
  }
  constexpr std::string_view disk = "disk:";
  int taps = 0;
  const bool is_disk = text.rfind(disk, 0) == 0;
  const char *end = text.data() + text.size();
  const auto [after, error] = std::from_chars(text.data() + (is_disk ? disk.size() : text.size()), end, taps);
  if (!is_disk || error != std::errc() || after != end || taps < 1 || taps > 64) {
    throw UsageError(fmt::format("--pcf '{}' is none of 1, 3x3, 5x5 and disk:N with N from 1 to 64", text));
  }
  return {.width = 0, .taps = taps};
}

/**
 * With at least this number of samples per pixel, most of the remaining error is at the edges of shadows. Halving the
 * size of shadow texels halves this error, and the cost of drawing them is spread over the samples.
 */
constexpr int fine_shadow_samples = 16;

eevee::ShadowSettings shadow_settings(const RenderOptions &options)
{
  static const std::map<std::string, scene::ShadowKind> kinds = {{"none", scene::ShadowKind::None},
                                                                 {"hard", scene::ShadowKind::Hard},
                                                                 {"pcf", scene::ShadowKind::Pcf},
                                                                 {"esm", scene::ShadowKind::Esm},
                                                                 {"evsm", scene::ShadowKind::Evsm}};
  static const std::map<std::string, eevee::EsmKernel> kernels = {
      {"4", eevee::EsmKernel::Disk4}, {"32", eevee::EsmKernel::Disk32}, {"separable", eevee::EsmKernel::Separable}};
  static const std::map<std::string, eevee::LayerPass> passes = {{"best", eevee::LayerPass::Best},
                                                                 {"six", eevee::LayerPass::Single},
                                                                 {"geometry", eevee::LayerPass::Geometry},
                                                                 {"layered", eevee::LayerPass::Layered}};
  static const std::map<std::string, eevee::CasterFaces> faces = {
      {"all", eevee::CasterFaces::All}, {"front", eevee::CasterFaces::Front}, {"back", eevee::CasterFaces::Back}};
  eevee::ShadowSettings settings;
  settings.kind = kinds.at(options.shadow);
  settings.esm.kernel = kernels.at(options.esm);
  settings.pcf = parse_pcf(options.pcf);
  settings.cascades.count = options.cascades;
  settings.cascades.lambda = options.cascade_lambda;
  settings.cascades.is_fitted_to_depth = options.cascade_range == "depth";
  settings.layer_pass = passes.at(options.cube_pass);
  settings.caster_faces = faces.at(options.casters);
  settings.memory_bytes_max = std::size_t(options.shadow_memory) << 20U;
  if (options.shadow_size > 0) {
    settings.cube_size_px = options.shadow_size;
    settings.map_size_px = options.shadow_size;
    settings.esm.size_px = std::clamp(options.shadow_size, 4, 8192);
  }
  else if (options.samples == 0 || options.samples >= fine_shadow_samples) {
    settings.cube_size_px *= 2;
    settings.map_size_px *= 2;
    settings.esm.size_px *= 2;
  }
  return settings;
}

eevee::Settings engine_settings(const RenderOptions &options)
{
  eevee::Settings settings;
  settings.shadow = shadow_settings(options);
  // The number of samples that fit into a time is not known beforehand.
  settings.sample_count = std::isfinite(options.seconds_max) ? 0 : options.samples;
  settings.seed = options.seed;
  settings.has_cascade_tint = options.debug_view.kind == DebugView::Kind::Cascades;
  settings.is_timed = !options.json.empty() || options.is_explained;
  return settings;
}

nlohmann::json to_json(const RenderOptions &options, const scene::Scene &scene, const scene::Camera &camera,
                       const RenderResult &result, const Chooser *chooser)
{
  nlohmann::json frames = nlohmann::json::array();
  for (std::size_t i = 0; i < result.frame_seconds.size(); i++) {
    nlohmann::json steps = nlohmann::json::object();
    for (const eevee::StepTime &step : result.frame_steps[i]) {
      steps[step.step] = step.seconds;
    }
    frames.push_back({{"seconds", result.frame_seconds[i]},
                      {"step_seconds", steps},
                      {"lamps_updated", result.frame_shadows[i].lamps_updated},
                      {"faces_drawn", result.frame_shadows[i].faces_drawn},
                      {"faces_skipped", result.frame_shadows[i].faces_skipped},
                      {"caster_draws", result.frame_shadows[i].caster_draws}});
  }
  nlohmann::json made = nlohmann::json::array();
  nlohmann::json left_out = nlohmann::json::array();
  for (const eevee::FramePart &part : result.report.parts) {
    (part.is_made ? made : left_out).push_back({{"what", part.what}, {"why", part.why}});
  }
  std::vector<std::string> warnings = scene.warnings;
  warnings.insert(warnings.end(), result.report.warnings.begin(), result.report.warnings.end());
  const gpu::Counters &c = result.counters;
  return {{"program", "gnomon " GNOMON_VERSION},
          {"scene", options.scene},
          {"output", options.output},
          {"camera", camera.name},
          {"size", options.size},
          {"samples", result.samples_drawn},
          {"seed", options.seed},
          {"device", result.device},
          {"import_seconds", result.import_seconds},
          {"device_seconds", result.device_seconds},
          {"sync_seconds", result.sync_seconds},
          {"frame_seconds", result.frame_seconds},
          {"frames", frames},
          {"skipped_frames", result.skipped_frame_count},
          {"output_seconds", result.output_seconds},
          {"total_seconds", result.total_seconds},
          {"non_finite", result.non_finite_count},
          {"counters",
           {{"passes", c.passes},
            {"draws", c.draws},
            {"instances", c.instances},
            {"triangles", c.triangles},
            {"shader_binds", c.shader_binds},
            {"shaders_made", c.shaders_made},
            {"shaders_from_cache", c.shaders_from_cache},
            {"textures_made", c.textures_made},
            {"upload_bytes", c.upload_bytes}}},
          {"memory_bytes", result.memory_bytes},
          {"made", made},
          {"left_out", left_out},
          {"frame_tree", tree_json(result.report.tree)},
          {"choice", chooser ? chooser->to_json() : nlohmann::json()},
          {"limits", result.report.limits},
          {"warnings", warnings}};
}

void print_summary(const RenderOptions &options, const RenderResult &result)
{
  fmt::print("{}\n", result.device);
  fmt::print("import {:.1f} ms, device {:.1f} ms, set-up {:.1f} ms", 1e3 * result.import_seconds,
             1e3 * result.device_seconds, 1e3 * result.sync_seconds);
  if (!result.frame_seconds.empty()) {
    fmt::print(", first frame {:.1f} ms", 1e3 * result.frame_seconds.front());
  }
  if (result.frame_seconds.size() > 1) {
    std::vector<double> warm(result.frame_seconds.begin() + 1, result.frame_seconds.end());
    std::ranges::sort(warm);
    fmt::print(", warm frame {:.1f} ms (median of {})", 1e3 * warm[warm.size() / 2], warm.size());
  }
  fmt::print(", output {:.1f} ms, all {:.1f} ms\n", 1e3 * result.output_seconds, 1e3 * result.total_seconds);
  if (result.skipped_frame_count > 0) {
    fmt::print("{} frames were skipped, because their files are complete\n", result.skipped_frame_count);
  }
  std::vector<std::string> made;
  for (const eevee::FramePart &part : result.report.parts) {
    if (part.is_made) {
      made.push_back(part.what);
    }
  }
  fmt::print("made: {}\n", fmt::join(made, ", "));
  if (!options.output.empty() && options.backend == "gl") {
    fmt::print("{}\n", fs::absolute(options.output).lexically_normal().string());
  }
}

void show_progress(int done, int count)
{
  if (count != 1 && isatty(STDERR_FILENO)) {
    fmt::print(stderr, "\r\033[K{}{} samples", done, count > 0 ? fmt::format("/{}", count) : "");
  }
}

void end_progress(int count)
{
  if (count != 1 && isatty(STDERR_FILENO)) {
    fmt::print(stderr, "\r\033[K");
  }
}

/** The texture for the display-referred picture of a PNG. Empty for other outputs and for --debug shadow. */
std::optional<draw::TargetTexture> make_display(const RenderOptions &options, gpu::Device &device, glm::ivec2 size_px)
{
  if (!is_png(options.output) || options.debug_view.kind == DebugView::Kind::Shadow) {
    return std::nullopt;
  }
  return std::make_optional<draw::TargetTexture>(device, "display", gpu::Format::RGBA8, size_px);
}

void render_frames(const RenderOptions &options, const scene::PlacedCamera &camera, eevee::SceneRenderer &renderer,
                   const std::optional<draw::TargetTexture> &display, RenderResult &result)
{
  draw::Target target = display ? display->target() : draw::Target();
  target.view_transform = view_transforms.at(options.view);
  target.exposure = options.exposure;

  eevee::ShadowCounters before = renderer.inspect().shadow_counters();
  for (int frame = 0; frame < options.repeat; frame++) {
    const Clock::time_point start = Clock::now();
    const auto progress = [&](int samples_drawn) {
      show_progress(samples_drawn, options.samples);
      return samples_drawn != options.samples;
    };
    result.samples_drawn = renderer.draw(camera, {.progress = progress, .seconds_max = options.seconds_max}, target);
    end_progress(options.samples);
    renderer.viewport().device().finish();
    result.frame_seconds.push_back(seconds_since(start));
    result.frame_steps.push_back(renderer.inspect().take_step_times());
    const eevee::ShadowCounters now = renderer.inspect().shadow_counters();
    result.frame_shadows.push_back({now.lamps_updated - before.lamps_updated, now.faces_drawn - before.faces_drawn,
                                    now.faces_skipped - before.faces_skipped, now.caster_draws - before.caster_draws});
    before = now;
  }
}

/** \return Status::Done, or Status::NonFinite if the picture has non-finite values; it is then not written */
Status write_picture(const RenderOptions &options, const scene::Camera &camera, gpu::Device &device,
                     std::span<const glm::vec4> pixels, glm::ivec2 size_px,
                     const std::optional<draw::TargetTexture> &display, const Metadata &frame_metadata,
                     RenderResult &result)
{
  const bool is_shadow = options.debug_view.kind == DebugView::Kind::Shadow;
  const std::span<const float> values = floats(pixels);
  const NonFinite non_finite = find_non_finite(size_px, values);
  result.non_finite_count = non_finite.count;
  if (non_finite.count > 0) {
    fmt::print(stderr,
               "gnomon: {}: {} values of the picture are not finite, the first at pixel ({}, {}); not written\n",
               options.scene, non_finite.count, non_finite.first_px.x, non_finite.first_px.y);
    return Status::NonFinite;
  }
  Metadata metadata = {{"gnomon:scene", options.scene},
                       {"gnomon:camera", camera.name},
                       {"gnomon:samples", std::to_string(result.samples_drawn)},
                       {"gnomon:seed", std::to_string(options.seed)},
                       {"gnomon:device", result.device}};
  metadata.insert(metadata.end(), frame_metadata.begin(), frame_metadata.end());
  if (!options.debug.empty()) {
    metadata.emplace_back("gnomon:debug", options.debug);
  }
  if (is_png(options.output)) {
    metadata.emplace_back("gnomon:units", fmt::format("display-referred, {}", is_shadow ? "raw" : options.view));
    write_png(options.output, size_px,
              display ? gpu::read_as<std::uint8_t>(device, display->texture()) : to_bytes(values), metadata);
  }
  else {
    metadata.emplace_back("gnomon:units",
                          is_shadow ? "metres, 0 where nothing was drawn" : "scene-linear radiance, W/(sr m^2)");
    const std::vector<float> distances = is_shadow ? alpha_in_all(values) : std::vector<float>();
    write_exr(options.output, size_px, is_shadow ? distances : values, metadata);
  }
  return Status::Done;
}

Status render(RenderOptions options)
{
  const Clock::time_point start = Clock::now();
  check_options(options);
  options.debug_view = parse_debug(options.debug);
  const glm::ivec2 size_px = parse_size(options.size);
  check_folder(options.output);
  check_folder(options.json);
  const FrameSequence frames(options.frames, options.output);
  RenderResult result;

  scene::Scene scene = gltf::import_gltf(options.scene);
  frames.pose(scene, 0);
  scene::PlacedCamera camera = find_camera(scene, options.camera);
  const bool is_default_studio = light_by_world(scene, camera, options.world);
  constexpr glm::vec3 light_grey(0.6F);
  const eevee::Background background = background_of(
      options.world, is_default_studio && is_png(options.output) ? std::optional(light_grey) : std::nullopt);
  for (const std::string &warning : scene.warnings) {
    fmt::print(stderr, "gnomon: warning: {}\n", warning);
  }
  result.import_seconds = seconds_since(start);

  const Clock::time_point device_start = Clock::now();
  const std::unique_ptr<gpu::Device> device =
      options.backend == "null" ? gpu::create_null_device()
                                : gpu::create_gl_device({.shader_cache_folder = gpu::default_shader_cache_folder()});
  result.device = device->description();
  result.device_seconds = seconds_since(device_start);

  std::unique_ptr<Chooser> chooser;
  if (options.choice.is_asked()) {
    chooser = std::make_unique<Chooser>(options.choice, *device, scene, camera, size_px);
    chooser->print_choice();
    options.samples = chooser->choice().sample_count;
  }
  const Clock::time_point sync_start = Clock::now();
  eevee::Settings settings = engine_settings(options);
  // --max-error applies to surfaces, so the picture is rendered without a background.
  settings.background = chooser ? eevee::Background() : background;
  if (chooser) {
    settings.shadow = chooser->choice().technique.settings;
  }
  if (options.debug_view.kind == DebugView::Kind::Shadow) {
    // Draw only one sample. It draws the shadow maps with the same size as all further samples.
    options.samples = settings.sample_count = 1;
  }
  eevee::SceneRenderer renderer(*device, scene, size_px, settings);
  eevee::Engine &engine = renderer.engine();
  draw::Viewport &viewport = renderer.viewport();
  renderer.sync();
  result.report = eevee::Inspection(engine, viewport).report();
  for (const std::string &warning : result.report.warnings) {
    fmt::print(stderr, "gnomon: warning: {}\n", warning);
  }
  for (const std::string &limit : result.report.limits) {
    fmt::print(stderr, "gnomon: limit: {}\n", limit);
  }
  if (options.debug_view.kind == DebugView::Kind::Cascades && !eevee::Inspection(engine, viewport).tinted_sun()) {
    throw std::runtime_error(fmt::format("{}: no sun has a shadow, so there are no cascades", scene.path));
  }
  result.sync_seconds = seconds_since(sync_start);

  const std::optional<draw::TargetTexture> display = make_display(options, *device, size_px);
  Status status = Status::Done;
  const Clock::time_point frames_start = Clock::now();
  int rendered_count = 0;
  for (int i = 0; i < frames.count() && status == Status::Done; i++) {
    options.output = frames.path(i).string();
    if (frames.is_done(i, size_px)) {
      result.skipped_frame_count++;
      continue;
    }
    if (i > 0) {
      frames.pose(scene, i);
      camera = find_camera(scene, options.camera);
      renderer.sync();
    }
    render_frames(options, camera, renderer, display, result);
    const Clock::time_point output_start = Clock::now();
    // Also called for the null backend, because shadow_picture reports layers that do not exist.
    if (options.debug_view.kind == DebugView::Kind::Shadow) {
      const gpu::Texture &picture = shadow_picture(options.debug_view, scene, engine, viewport);
      if (options.backend == "gl") {
        status = write_picture(options, camera, *device, gpu::read_as<glm::vec4>(*device, picture),
                               {picture.desc().width, picture.desc().height}, display, frames.metadata(i), result);
      }
    }
    else if (options.backend == "gl") {
      status = write_picture(options, camera, *device, renderer.read_picture(), size_px, display, frames.metadata(i),
                             result);
    }
    result.output_seconds += seconds_since(output_start);
    frames.show_progress(i, ++rendered_count, seconds_since(frames_start));
  }
  result.report = eevee::Inspection(engine, viewport).report();
  if (options.backend != "gl") {
    fmt::print(stderr, "gnomon: the null backend draws nothing: no picture is written\n");
  }
  result.counters = device->counters();
  result.memory_bytes = device->memory_bytes();
  result.total_seconds = seconds_since(start);
  if (chooser && status == Status::Done) {
    chooser->measure(renderer.read_picture(), result.frame_seconds.front());
    for (const std::string &limit : chooser->limits()) {
      fmt::print(stderr, "gnomon: limit: {}\n", limit);
      result.report.limits.push_back(limit);
    }
  }
  if (!options.json.empty()) {
    write_atomically(options.json, [&](const fs::path &beside) {
      std::ofstream file(beside);
      file << to_json(options, scene, camera, result, chooser.get())
                  .dump(2, ' ', false, nlohmann::json::error_handler_t::replace)
           << "\n";
      if (!file.flush()) {
        throw std::runtime_error(fmt::format("{}: cannot be written", options.json));
      }
    });
  }
  if (status == Status::Done) {
    print_summary(options, result);
    if (chooser) {
      chooser->print_measured();
    }
    if (options.is_explained) {
      fmt::print("{}", tree_text(result.report.tree));
    }
  }
  return status == Status::Done && options.is_strict && !result.report.limits.empty() ? Status::Limit : status;
}

}  // namespace

void add_render(CLI::App &app, Status &status)
{
  auto o = std::make_shared<RenderOptions>();
  CLI::App *command = app.add_subcommand("render", "Light a scene and write the picture");
  command->add_option("scene", o->scene, "glTF 2.0 file")->required();
  command->add_option("-o,--output", o->output,
                      "OUT.exr: scene-linear floats; OUT.png: display colours after the view transform");
  command->add_option("--size", o->size, "WIDTHxHEIGHT, pixels")->capture_default_str();
  command->add_option("--camera", o->camera, "Name of the camera (default: the first)");
  CLI::Option *samples = command->add_option("--samples", o->samples, "Samples per pixel")
                             ->capture_default_str()
                             ->check(CLI::Range(1, 65536));
  CLI::Option *time_limit =
      command
          ->add_option(
              "--time-limit", o->seconds_max,
              "Time for each picture, s: draw samples until it has passed; --samples, if given, is an upper limit")
          ->check(CLI::Range(1e-3, 1e9));
  CLI::Option *frames = command->add_option(
      "--frames", o->frames.range, "Frames A-B or A of an animation; the frame number replaces the # characters in -o");
  command->add_option("--fps", o->frames.frames_per_second, "Frames per second of an animation; frame 0 is at 0 s")
      ->needs(frames)
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1e6));
  command->add_option("--animation", o->frames.animation, "Name of the animation (default: the first)")->needs(frames);
  command->add_flag("--resume", o->frames.is_resumed, "Skip frames whose files are complete and have the same size")
      ->needs(frames);
  command->add_option("--repeat", o->repeat, "Number of times to render the picture, to measure its time")
      ->excludes(frames)
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  command
      ->add_option("--shadow", o->shadow,
                   "Shadows of lamps without gnomon_shadow: none, hard, pcf, esm, evsm; none disables all shadows")
      ->capture_default_str()
      ->check(CLI::IsMember({"none", "hard", "pcf", "esm", "evsm"}));
  command
      ->add_option(
          "--shadow-size", o->shadow_size,
          "Width of cube faces, maps and octahedral layers, pixels (default: 1024, 2048, 512; twice that with at least "
          "16 samples)")
      ->check(CLI::Range(1, 16384));
  command->add_option("--pcf", o->pcf, "Filter kernel of --shadow pcf: 1, 3x3, 5x5, or disk:N for N lookups on a disk")
      ->capture_default_str();
  command->add_option("--esm", o->esm, "Filter taps of --shadow esm and evsm: 4, 32, or separable")
      ->capture_default_str()
      ->check(CLI::IsMember({"4", "32", "separable"}));
  command
      ->add_option("--cascades", o->cascades,
                   "Shadow maps of each sun; 0: as many as needed for texels no larger than pixels")
      ->capture_default_str()
      ->check(CLI::Range(0, eevee::cascade_count_max));
  command
      ->add_option("--cascade-lambda", o->cascade_lambda,
                   "Distribution of the cascades over the distance: 0 even, 1 logarithmic")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  command
      ->add_option("--cascade-range", o->cascade_range,
                   "Range that the cascades cover: view, the scene within the camera's frustum; depth, the visible "
                   "surfaces")
      ->capture_default_str()
      ->check(CLI::IsMember({"view", "depth"}));
  command
      ->add_option("--cube-pass", o->cube_pass,
                   "Drawing of the layers of a lamp: six (one pass for each), geometry or layered (one pass for all), "
                   "best")
      ->capture_default_str()
      ->check(CLI::IsMember({"best", "six", "geometry", "layered"}));
  command->add_option("--casters", o->casters, "Faces of one-sided materials that cast shadows: all, front, back")
      ->capture_default_str()
      ->check(CLI::IsMember({"all", "front", "back"}));
  command
      ->add_option("--shadow-memory", o->shadow_memory,
                   "Maximum memory of shadow layers, MiB; their sizes are reduced to fit")
      ->capture_default_str()
      ->check(CLI::Range(1, 1 << 20));
  command->add_option("--debug", o->debug,
                      "shadow:LAMP[:LAYER]: distances in the layers of a shadow (a cube face, a cascade, octahedral, "
                      "all) instead of the picture; cascades: the picture, tinted by the cascade that a pixel reads");
  command->add_option("--aov", o->aov, "Additional layers to write (not built yet)");
  command->add_option("--view", o->view, "View transform of a PNG: standard, raw, agx, pbr-neutral")
      ->capture_default_str()
      ->check(CLI::IsMember(view_transforms));
  command->add_option("--exposure", o->exposure, "Exposure of a PNG, stops")
      ->capture_default_str()
      ->check(CLI::Range(-64.0, 64.0));
  command->add_option("--backend", o->backend, "gl, or null: record without a driver and draw nothing")
      ->capture_default_str()
      ->check(CLI::IsMember({"gl", "null"}));
  command->add_flag("--explain", o->is_explained, "Print the parts of the frame, and the parts that were left out");
  command->add_option("--json", o->json, "Write times, counters, limits, and the parts that were made and left out");
  add_world_options(*command, o->world);
  CLI::Option *max_error =
      command
          ->add_option("--max-error", o->choice.error_max,
                       "Choose the fastest shadows and samples with at most this RMSE against ray tracing")
          ->check(CLI::Range(1e-6, 1e6));
  CLI::Option *max_time =
      command
          ->add_option("--max-time", o->choice.milliseconds_max,
                       "Choose the most exact shadows and samples within this time for a picture, ms")
          ->check(CLI::Range(1e-3, 1e9))
          ->excludes(max_error);
  // These options set what is chosen automatically, or change the picture so that its error cannot be measured.
  for (const char *name :
       {"--samples", "--time-limit", "--shadow", "--shadow-size", "--pcf", "--esm", "--cascades", "--cascade-lambda",
        "--cascade-range", "--cube-pass", "--casters", "--shadow-memory", "--debug", "--frames", "--background"}) {
    max_error->excludes(command->get_option(name));
    max_time->excludes(command->get_option(name));
  }
  command->add_option("--report", o->choice.report_folder,
                      "Folder of gnomon report to choose from (default: render a pilot)");
  command->add_flag("--strict", o->is_strict, "End with status 4 if a limit was hit");
  command->add_option("--seed", o->seed, "Seed of the sample pattern")->capture_default_str();
  command->callback([o, samples, time_limit, &status] {
    if (time_limit->count() > 0 && samples->count() == 0) {
      o->samples = 0;
    }
    status = render(*o);
  });
}

}  // namespace gnomon::cli
