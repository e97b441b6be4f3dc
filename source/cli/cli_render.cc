// SPDX-License-Identifier: MIT
#include "cli.hh"

#include "cli_aov.hh"
#include "cli_explain.hh"
#include "cli_exr_part.hh"
#include "cli_output.hh"
#include "cli_picture.hh"
#include "cli_render_options.hh"
#include "cli_render_report.hh"
#include "cli_time.hh"
#include "cli_trace.hh"

#include "eevee_scene_renderer.hh"
#include "eevee_texel_density.hh"
#include "eevee_world.hh"
#include "gpu_read.hh"
#include "output_roles.hh"
#include "trace.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <unistd.h>
#include <algorithm>
#include <future>
#include <iterator>
#include <optional>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

/** The outputs, and the inputs that are known before the scene is read. */
output::Roles files_of(const RenderOptions &options, const FrameSequence &frames)
{
  output::Roles roles;
  roles.add_input(options.scene, "the scene");
  if (!options.choice.report_folder.empty()) {
    roles.add_input(fs::path(options.choice.report_folder) / "report.json", "--report");
  }
  roles.add_output(options.json, "--json");
  roles.add_output(options.trace, "--trace");
  for (int i = 0; options.has_picture() && i < frames.count(); i++) {
    roles.add_output(frames.path(i), "-o");
  }
  return roles;
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

void show_progress(int done, int count)
{
  if (count != 1 && isatty(STDERR_FILENO)) {
    print_message("\r\033[K{}{} samples", done, count > 0 ? fmt::format("/{}", count) : "");
  }
}

void end_progress(int count)
{
  if (count != 1 && isatty(STDERR_FILENO)) {
    print_message("\r\033[K");
  }
}

/** The texture for the display-referred picture of a PNG. Empty for other outputs and for --debug shadow. */
std::optional<draw::TargetTexture> make_display(const RenderOptions &options, gpu::Device &device, glm::ivec2 size_px)
{
  if (!options.is_png() || options.is_shadow_shown()) {
    return std::nullopt;
  }
  return std::make_optional<draw::TargetTexture>(device, "display", gpu::Format::RGBA8, size_px);
}

/** Pictures without a background are written with alpha. */
Alpha alpha_of(const RenderOptions &options, eevee::SceneRenderer &renderer)
{
  const bool is_picture = !options.is_shadow_shown() && (!options.is_density_shown() || options.is_png());
  return !is_picture || eevee::has_background(renderer.settings(), renderer.render_scene()) ? Alpha::Dropped
                                                                                            : Alpha::Written;
}

void render_frames(const RenderOptions &options, const scene::PlacedCamera &camera, eevee::SceneRenderer &renderer,
                   const std::optional<draw::TargetTexture> &display, RenderResult &result)
{
  draw::Target target = display ? display->target() : draw::Target();
  const render_scene::Display shown = options.display();
  target.view_transform = shown.view_transform;
  target.exposure = shown.exposure;
  target.composition = draw::Composition::ReplaceStraight;

  const int sample_count = options.sample_range.empty() ? options.samples : renderer.settings().drawn_sample_count();
  eevee::ShadowCounters before = renderer.inspect().shadow_counters();
  for (int frame = 0; frame < options.repeat; frame++) {
    if (options.redraws_shadows) {
      renderer.inspect().invalidate_shadows();
    }
    const Clock::time_point start = Clock::now();
    const auto progress = [&](int samples_drawn) {
      show_progress(samples_drawn, sample_count);
      return samples_drawn != sample_count;
    };
    const trace::Span span("picture");
    result.samples_drawn = renderer.draw(camera, {.progress = progress, .seconds_max = options.seconds_max}, target);
    end_progress(sample_count);
    renderer.viewport().device().finish();
    result.frame_seconds.push_back(seconds_since(start));
    result.frame_steps.push_back(renderer.inspect().take_step_times());
    const eevee::ShadowCounters now = renderer.inspect().shadow_counters();
    result.frame_shadows.push_back({now.lamps_updated - before.lamps_updated, now.faces_drawn - before.faces_drawn,
                                    now.faces_skipped - before.faces_skipped, now.caster_draws - before.caster_draws});
    before = now;
  }
}

/** Writes the \a pixels of options.region() for `gnomon merge`. */
void write_part(const RenderOptions &options, std::span<const glm::vec4> pixels, Alpha alpha, double sample_share,
                Metadata metadata)
{
  const glm::ivec2 whole_px = options.size_px();
  const gpu::Rectangle region = options.region();
  metadata.emplace_back(share_metadata, fmt::format("{}", sample_share));
  const glm::ivec2 range = options.sample_bounds();
  metadata.emplace_back(range_metadata, fmt::format("{}-{}", range.x, range.y));
  metadata.emplace_back("gnomon:settings", options.settings_text);
  ExrPart part{whole_px,
               region.size_px,
               {region.origin_px.x, whole_px.y - region.origin_px.y - region.size_px.y},
               {},
               std::move(metadata)};
  const std::string_view names = alpha == Alpha::Written ? "RGBA" : "RGB";
  for (std::size_t i = 0; i < names.size(); i++) {
    std::vector<float> &channel = part.channels[std::string(1, names[i])];
    channel.reserve(pixels.size());
    for (int y = region.size_px.y - 1; y >= 0; y--) {
      const auto row = pixels.subspan(std::size_t(y) * std::size_t(region.size_px.x), std::size_t(region.size_px.x));
      std::ranges::transform(row, std::back_inserter(channel),
                             [&](const glm::vec4 &pixel) { return pixel[glm::length_t(i)]; });
    }
  }
  write_exr_part(options.output, part);
}

/** Counts non-finite values of the picture or of a layer, and prints where the first is. */
std::size_t count_non_finite(const RenderOptions &options, std::string_view what, glm::ivec2 size_px,
                             std::span<const float> values, std::size_t channel_count)
{
  const NonFinite found = find_non_finite(size_px, values, channel_count);
  if (found.count > 0) {
    print_message("gnomon: {}: {} values of {} are not finite, the first at pixel ({}, {}); not written\n",
                  options.scene, found.count, what, found.first_px.x, found.first_px.y);
  }
  return found.count;
}

/** What the values of the output are. */
std::string units_of(const RenderOptions &options)
{
  if (options.is_png()) {
    return fmt::format("display-referred, {}",
                       options.is_shadow_shown()
                           ? "raw"
                           : scene::words<draw::ViewTransform>[std::size_t(options.display().view_transform)]);
  }
  return options.is_shadow_shown()    ? "metres, 0 where nothing was drawn"
         : options.is_density_shown() ? "shadow texels along the edge of a pixel, 0 where there is no shadow"
                                      : "scene-linear radiance, W/(sr m^2)";
}

/** \return Status::Done, or Status::NonFinite if the picture has non-finite values; it is then not written */
Status write_picture(const RenderOptions &options, const scene::Camera &camera, gpu::Device &device,
                     std::span<const glm::vec4> pixels, glm::ivec2 size_px,
                     const std::optional<draw::TargetTexture> &display, std::span<const float> density, Alpha alpha,
                     const AovLayers &aov, double sample_share, const Metadata &frame_metadata, RenderResult &result)
{
  const trace::Span span("write picture");
  const bool is_shadow = options.is_shadow_shown();
  const std::span<const float> values = floats(pixels);
  result.non_finite_count = count_non_finite(options, "the picture", size_px, values, 4);
  for (const Layer &layer : aov.layers) {
    result.non_finite_count += count_non_finite(options, fmt::format("the layer '{}'", layer.name), size_px,
                                                layer.values, layer.channels.size());
  }
  if (result.non_finite_count > 0) {
    return Status::NonFinite;
  }
  Metadata metadata = {{"gnomon:scene", options.scene},
                       {"gnomon:camera", camera.name},
                       {"gnomon:samples", std::to_string(options.is_part() ? options.samples : result.samples_drawn)},
                       {"gnomon:seed", std::to_string(options.engine_settings().seed)},
                       {"gnomon:device", result.device}};
  metadata.insert(metadata.end(), frame_metadata.begin(), frame_metadata.end());
  metadata.insert(metadata.end(), aov.metadata.begin(), aov.metadata.end());
  if (!options.debug.empty()) {
    metadata.emplace_back("gnomon:debug", options.debug);
  }
  metadata.emplace_back("gnomon:units", units_of(options));
  if (options.is_png()) {
    std::vector<std::uint8_t> bytes =
        display ? gpu::read_as<std::uint8_t>(device, display->texture()) : to_bytes(values);
    if (!density.empty()) {
      eevee::show_texel_density(bytes, density);
    }
    write_png(options.output, size_px, bytes, metadata, alpha);
  }
  else {
    if (options.is_part()) {
      write_part(options, pixels, alpha, sample_share, std::move(metadata));
      return Status::Done;
    }
    const std::vector<float> distances = is_shadow ? alpha_in_all(values) : std::vector<float>();
    write_exr(options.output, size_px, is_shadow ? distances : values, metadata, alpha, aov.layers);
  }
  return Status::Done;
}

/** Prints one line for each text. \a kind: "warning" or "limit" */
void print_messages(std::string_view kind, const std::vector<std::string> &texts)
{
  for (const std::string &text : texts) {
    print_message("gnomon: {}: {}\n", kind, text);
  }
}

std::unique_ptr<gpu::Device> create_device(const RenderOptions &options)
{
  const trace::Span span("device");
  if (!options.has_picture()) {
    return gpu::create_null_device();
  }
  return gpu::create_gl_device({.shader_cache_folder = gpu::default_shader_cache_folder()});
}

struct Input {
  std::unique_ptr<gpu::Device> device;
  scene::Scene scene;
};

/** Imports the scene on another thread while the device is created. Both must not fail; the scene's error is the first.
 */
Input create_device_and_import(const RenderOptions &options, RenderResult &result)
{
  std::future<scene::Scene> imported = std::async(std::launch::async, [&] {
    const Clock::time_point start = Clock::now();
    scene::Scene scene = import_scene(options.scene, options.import_options());
    result.import_seconds = seconds_since(start);
    return scene;
  });
  Input input;
  try {
    const Clock::time_point start = Clock::now();
    input.device = create_device(options);
    result.device = input.device->description();
    result.device_seconds = seconds_since(start);
  }
  catch (...) {
    static_cast<void>(imported.get());
    throw;
  }
  input.scene = imported.get();
  return input;
}

/** Renders and writes all frames of the sequence. */
Status render_sequence(RenderOptions options, const FrameSequence &frames, const Aov &aov, scene::Scene &scene,
                       scene::PlacedCamera camera, eevee::SceneRenderer &renderer, RenderResult &result)
{
  gpu::Device &device = renderer.viewport().device();
  const glm::ivec2 size_px = renderer.viewport().size_px();
  const std::optional<draw::TargetTexture> display = make_display(options, device, size_px);
  Status status = Status::Done;
  const Clock::time_point start = Clock::now();
  int rendered_count = 0;
  frames.remove_unfinished_files();
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
    // Also called for the null backend, because both report lamps and layers that do not exist.
    const gpu::Texture *shadow = nullptr;
    if (options.is_shadow_shown()) {
      shadow = &shadow_picture(options.debug_view, scene, renderer.inspect());
    }
    std::vector<float> density;
    if (options.is_density_shown()) {
      const trace::Span span("texel density");
      const std::size_t lamp = shadowed_lamp(options.debug_view, scene, renderer.inspect());
      const auto values = renderer.inspect().texel_density(renderer.view_of(camera), lamp);
      if (!values) {
        throw std::runtime_error(fmt::format("{}: no object is drawn, on which the shadow of lamp '{}' could be seen",
                                             scene.path, options.debug_view.lamp));
      }
      density = *values;
    }
    if (!aov.empty()) {
      // The layers draw other pictures.
      result.report = renderer.inspect().report();
    }
    const Clock::time_point output_start = Clock::now();
    double layer_seconds = 0.0;
    if (options.has_picture()) {
      const gpu::Rectangle region = renderer.viewport().region();
      const glm::ivec2 written_px = shadow ? glm::ivec2(shadow->desc().width, shadow->desc().height) : region.size_px;
      std::vector<glm::vec4> picture =
          shadow ? gpu::read_as<glm::vec4>(device, *shadow) : gpu::cropped(renderer.read_picture(), size_px.x, region);
      if (options.is_density_shown() && !options.is_png()) {
        std::ranges::transform(density, picture.begin(), [](float value) { return glm::vec4(value); });
      }
      const double sample_share = renderer.engine().sample_share(renderer.viewport());
      const Clock::time_point layers_start = Clock::now();
      const AovLayers layers = aov.render(renderer, camera, result.samples_drawn);
      layer_seconds = seconds_since(layers_start);
      status = write_picture(options, camera, device, picture, written_px, display, density,
                             alpha_of(options, renderer), layers, sample_share, frames.metadata(i), result);
    }
    result.layer_seconds += layer_seconds;
    result.output_seconds += seconds_since(output_start) - layer_seconds;
    frames.show_progress(i, ++rendered_count, seconds_since(start));
  }
  return status;
}

Status render(RenderOptions options)
{
  const Clock::time_point start = Clock::now();
  const TraceFile trace_file(options.trace);
  options.check();
  options.debug_view = parse_debug(options.debug);
  const glm::ivec2 size_px = options.size_px();
  const FrameSequence frames(options.frames, options.output);
  output::Roles roles = files_of(options, frames);
  const Aov aov(options.aov);
  RenderResult result;

  auto [device, scene] = create_device_and_import(options, result);
  add_inputs(roles, scene, options.world);
  frames.pose(scene, 0);
  const scene::PlacedCamera camera = find_camera(scene, options.camera);
  const bool is_default_studio = light_by_world(scene, camera, options.world);
  constexpr glm::vec3 light_grey(0.6F);
  const eevee::Background background = background_of(
      options.background, is_default_studio && options.is_png() ? std::optional(light_grey) : std::nullopt);
  aov.check(scene);
  std::ranges::copy(aov.warnings(scene), std::back_inserter(scene.warnings));
  print_messages("warning", scene.warnings);

  std::unique_ptr<Chooser> chooser;
  if (options.choice.is_asked()) {
    chooser = std::make_unique<Chooser>(options.choice, *device, scene, camera, size_px,
                                        options.engine_settings().has_multiscatter);
    chooser->print_choice();
    options.samples = chooser->choice().sample_count;
  }
  const Clock::time_point sync_start = Clock::now();
  eevee::Settings settings = options.engine_settings();
  // --max-error applies to surfaces, so the picture is rendered without a background.
  settings.background = chooser ? eevee::Background() : background;
  if (chooser) {
    settings.shadow = chooser->choice().technique.settings;
  }
  if (options.is_shadow_shown()) {
    // Draw only one sample. It draws the shadow maps with the same size as all further samples.
    options.samples = settings.sample_count = 1;
  }
  eevee::SceneRenderer renderer(*device, scene, size_px, settings);
  renderer.sync();
  renderer.viewport().set_region(options.region());
  const eevee::Inspection inspection = renderer.inspect();
  result.report = inspection.report();
  print_messages("warning", result.report.warnings);
  print_messages("limit", result.report.limits);
  if (options.debug_view.kind == DebugView::Kind::Cascades && !inspection.tinted_sun()) {
    throw std::runtime_error(fmt::format("{}: no sun has a shadow, so there are no cascades", scene.path));
  }
  result.sync_seconds = seconds_since(sync_start);

  const Status status = render_sequence(options, frames, aov, scene, camera, renderer, result);
  if (aov.empty()) {
    result.report = inspection.report();
  }
  if (!options.has_picture()) {
    print_message("gnomon: the null backend draws nothing: no picture is written\n");
  }
  result.counters = device->counters();
  result.memory_bytes = device->memory_bytes();
  result.total_seconds = seconds_since(start);
  if (chooser && status == Status::Done) {
    chooser->measure(renderer.read_picture(), result.frame_seconds.front());
    const std::vector<std::string> limits = chooser->limits();
    print_messages("limit", limits);
    result.report.limits.insert(result.report.limits.end(), limits.begin(), limits.end());
  }
  write_json(options.json, to_json(options, settings, scene, camera, result, chooser.get()));
  trace_file.write();
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
  auto options = std::make_shared<RenderOptions>();
  CLI::App *command = app.add_subcommand("render", "Light a scene and write the picture");
  add_render_options(*command, *options);
  command->callback([options, &status] { status = render(*options); });
}

}  // namespace gnomon::cli
