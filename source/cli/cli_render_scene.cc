// SPDX-License-Identifier: MIT
#include "cli_render_scene.hh"

#include "cli_aov.hh"
#include "cli_device.hh"
#include "cli_explain.hh"
#include "cli_fingerprint.hh"
#include "cli_output.hh"
#include "cli_progress.hh"
#include "cli_render_output.hh"

#include "eevee_scene_renderer.hh"
#include "eevee_world.hh"
#include "gpu_read.hh"
#include "trace.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

/** The camera of the picture, with the lens that options ask for. */
scene::PlacedCamera find_camera(const scene::Scene &scene, const RenderOptions &options)
{
  std::vector<std::string> names;
  for (scene::PlacedCamera &camera : scene.placed_cameras()) {
    if (options.camera.empty() || camera.name == options.camera) {
      if (!options.camera_changes.empty() && camera.kind != scene::CameraKind::Perspective) {
        throw std::runtime_error(fmt::format(
            "{}: camera '{}' is orthographic; --aperture and --focus need a perspective one", scene.path, camera.name));
      }
      static_cast<scene::Camera &>(camera) = changed<scene::Camera>(camera, options.camera_changes);
      return camera;
    }
    names.push_back(camera.name);
  }
  throw std::runtime_error(
      fmt::format("{}: no camera '{}'; it has: {}", scene.path, options.camera, fmt::join(names, ", ")));
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

/** One scene of the command. */
struct SceneWork {
  const RenderOptions &options;
  const FrameSequence &frames;
  const StopRequests &stops;
  Progress &progress;
  RenderResult &result;
  /** ImportedScene::fingerprint. */
  const std::string &content;
};

/** \return whether the last picture has all samples that were asked for */
bool render_frames(const SceneWork &work, int picture, scene::Scene &scene, const scene::PlacedCamera &camera,
                   eevee::SceneRenderer &renderer, const std::optional<draw::TargetTexture> &display)
{
  const RenderOptions &options = work.options;
  RenderResult &result = work.result;
  draw::Target target = display ? display->target() : draw::Target();
  set_display(target, options.display());
  target.composition = draw::Composition::ReplaceStraight;

  const int sample_count = options.sample_range.empty() ? options.samples : renderer.settings().drawn_sample_count();
  eevee::ShadowCounters before = renderer.inspect().shadow_counters();
  for (int frame = 0; frame < options.repeat; frame++) {
    if (options.redraws_shadows) {
      renderer.inspect().invalidate_shadows();
    }
    const Clock::time_point start = Clock::now();
    bool is_stopped = false;
    const auto go_on = [&](int samples_drawn) {
      work.progress.drawn(picture, samples_drawn);
      is_stopped = samples_drawn != sample_count && work.stops.is_stopped();
      return samples_drawn != sample_count && !is_stopped;
    };
    const trace::Span span("picture");
    const eevee::DrawLimits limits{.progress = go_on, .seconds_max = options.seconds_max};
    const auto pose = [&](double place) {
      work.frames.pose(scene, picture, place);
      return find_camera(scene, options);
    };
    result.samples_drawn =
        work.frames.has_shutter() ? renderer.draw_moving(pose, limits, target) : renderer.draw(camera, limits, target);
    renderer.viewport().device().finish();
    result.frame_seconds.push_back(seconds_since(start));
    result.frame_steps.push_back(renderer.inspect().take_step_times());
    const eevee::ShadowCounters now = renderer.inspect().shadow_counters();
    result.frame_shadows.push_back({now.lamps_updated - before.lamps_updated, now.faces_drawn - before.faces_drawn,
                                    now.faces_skipped - before.faces_skipped, now.caster_draws - before.caster_draws});
    before = now;
    if (is_stopped) {
      return false;
    }
  }
  return true;
}

/** Prints one line for each text. \a kind: "warning" or "limit" */
void print_messages(std::string_view kind, const std::vector<std::string> &texts)
{
  for (const std::string &text : texts) {
    print_message("gnomon: {}: {}\n", kind, text);
  }
}

/** Prints those of \a texts that \a printed does not have. */
void print_new_messages(std::string_view kind, const std::vector<std::string> &texts,
                        const std::vector<std::string> &printed)
{
  std::vector<std::string> fresh;
  std::ranges::copy_if(texts, std::back_inserter(fresh),
                       [&](const std::string &text) { return std::ranges::find(printed, text) == printed.end(); });
  print_messages(kind, fresh);
}

/**
 * A fingerprint of the files that make a picture, so that parts of other content are not merged. \a scene: before it is
 * posed, which differs between processors
 */
std::string content_fingerprint(const scene::Scene &scene, const WorldOptions &world)
{
  std::error_code ignored;
  return scene_fingerprint(scene) + (fs::is_regular_file(world.world, ignored) ? file_fingerprint(world.world) : "");
}

/** Takes the rendered picture, or the debug view in its place, and the layers beside it, from the device. */
RenderedPicture take_picture(const SceneWork &work, const Aov &aov, const scene::Scene &scene,
                             const scene::PlacedCamera &camera, eevee::SceneRenderer &renderer,
                             const std::optional<draw::TargetTexture> &display, int index)
{
  const RenderOptions &options = work.options;
  gpu::Device &device = renderer.viewport().device();
  const glm::ivec2 size_px = renderer.viewport().size_px();
  const gpu::Rectangle region = renderer.viewport().region();
  RenderedPicture picture{.size_px = region.size_px,
                          .alpha = alpha_of(options, renderer),
                          .sample_count = work.result.samples_drawn,
                          .sample_share = renderer.engine().sample_share(renderer.viewport()),
                          .settings = options.settings_text(renderer.settings(), camera),
                          .metadata = work.frames.metadata(index)};
  picture.metadata.emplace_back("gnomon:camera", camera.name);
  picture.metadata.emplace_back("gnomon:device", work.result.device);
  if (!work.content.empty()) {
    picture.metadata.emplace_back("gnomon:content", work.content);
  }
  if (!options.plan_id.empty()) {
    std::ranges::copy(planned_metadata(options.plan_id, options.output), std::back_inserter(picture.metadata));
  }
  // Also called for the null backend, because both report lamps and layers that do not exist.
  const gpu::Texture *shadow = nullptr;
  if (options.is_shadow_shown()) {
    shadow = &shadow_picture(options.debug_view, scene, renderer.inspect());
    picture.size_px = {shadow->desc().width, shadow->desc().height};
  }
  if (options.is_density_shown()) {
    const trace::Span span("texel density");
    const std::size_t lamp = shadowed_lamp(options.debug_view, scene, renderer.inspect());
    const auto values = renderer.inspect().texel_density(renderer.view_of(camera), lamp);
    if (!values) {
      throw std::runtime_error(fmt::format("{}: no object is drawn, on which the shadow of lamp '{}' could be seen",
                                           scene.path, options.debug_view.lamp));
    }
    picture.density = *values;
  }
  if (!aov.empty()) {
    // The layers draw other pictures.
    work.result.report = renderer.inspect().report();
  }
  if (!options.has_picture()) {
    return picture;
  }
  picture.pixels =
      shadow ? gpu::read_as<glm::vec4>(device, *shadow) : gpu::cropped(renderer.read_picture(), size_px.x, region);
  if (options.is_density_shown() && !options.is_png()) {
    std::ranges::transform(picture.density, picture.pixels.begin(), [](float value) { return glm::vec4(value); });
  }
  if (display) {
    picture.display = gpu::read_as<std::uint8_t>(device, display->texture());
  }
  const Clock::time_point layers_start = Clock::now();
  picture.aov = aov.render(renderer, camera, work.result.samples_drawn);
  work.result.layer_seconds += seconds_since(layers_start);
  return picture;
}

/** The picture that another thread writes while the next is drawn. */
class PictureInWriting {
 public:
  explicit PictureInWriting(const SceneWork &work) : work_(work) {}

  /** Waits for the picture before, and begins to write \a picture. \return false, as finish */
  bool start(const RenderOptions &options, RenderedPicture picture, int index, double seconds_left)
  {
    if (!finish()) {
      return false;
    }
    index_ = index;
    seconds_left_ = seconds_left;
    writing_ = std::async(std::launch::async, [options, picture = std::move(picture)] {
      const trace::Span span("write picture");
      return options.has_picture() ? write_picture(options, picture) : 0;
    });
    return true;
  }
  /** \return false if values of the picture are not finite. \throws the exceptions of write_picture */
  bool finish()
  {
    if (!writing_.valid()) {
      return true;
    }
    work_.result.non_finite_count = writing_.get();
    if (work_.result.non_finite_count > 0) {
      return false;
    }
    if (work_.options.has_checkpoint) {
      RenderOptions options = work_.options;
      options.output = work_.frames.path(index_).string();
      std::error_code ignored;
      fs::remove(checkpoint_path(options), ignored);
    }
    work_.progress.written(index_, seconds_left_);
    return true;
  }

 private:
  const SceneWork &work_;
  int index_ = 0;
  double seconds_left_ = 0.0;
  std::future<std::size_t> writing_;
};

/** Renders all frames of the sequence, and writes all but the last. */
Status render_sequence(const SceneWork &work, const Aov &aov, scene::Scene &scene, scene::PlacedCamera camera,
                       eevee::SceneRenderer &renderer, PictureInWriting &writing)
{
  RenderOptions options = work.options;
  RenderResult &result = work.result;
  const FrameSequence &frames = work.frames;
  const glm::ivec2 size_px = renderer.viewport().size_px();
  const std::optional<draw::TargetTexture> display = make_display(options, renderer.viewport().device(), size_px);
  const Clock::time_point start = Clock::now();
  int rendered_count = 0;
  frames.remove_unfinished_files();
  for (int i = 0; i < frames.count(); i++) {
    options.output = frames.path(i).string();
    if (frames.is_done(i, size_px, options.plan_id)) {
      result.skipped_frame_count++;
      continue;
    }
    if (work.stops.is_stopped()) {
      return Status::Stopped;
    }
    if (i > 0) {
      frames.pose(scene, i);
      camera = find_camera(scene, options);
      renderer.sync();
    }
    const SceneWork frame_work{options, frames, work.stops, work.progress, result, work.content};
    const bool is_complete = render_frames(frame_work, i, scene, camera, renderer, display);
    if (!is_complete && !options.has_checkpoint) {
      return Status::Stopped;
    }
    const Clock::time_point output_start = Clock::now();
    const double layer_seconds = result.layer_seconds;
    RenderedPicture picture = take_picture(frame_work, aov, scene, camera, renderer, display, i);
    if (!is_complete) {
      const fs::path path = write_checkpoint(options, picture);
      print_message("gnomon: {}: samples {} to {}\n", path.string(), options.sample_bounds().x,
                    options.sample_bounds().x + picture.sample_count - 1);
      return Status::Stopped;
    }
    rendered_count++;
    const double seconds_left = seconds_since(start) / rendered_count * (frames.count() - i - 1);
    if (!writing.start(options, std::move(picture), i, seconds_left)) {
      return Status::NonFinite;
    }
    result.output_seconds += seconds_since(output_start) - (result.layer_seconds - layer_seconds);
  }
  return Status::Done;
}

/** Renders and writes all frames of the sequence. */
Status render_sequence(const SceneWork &work, const Aov &aov, scene::Scene &scene, const scene::PlacedCamera &camera,
                       eevee::SceneRenderer &renderer)
{
  PictureInWriting writing(work);
  const Status status = render_sequence(work, aov, scene, camera, renderer, writing);
  const Clock::time_point output_start = Clock::now();
  const bool is_finite = writing.finish();
  work.result.output_seconds += seconds_since(output_start);
  return is_finite ? status : Status::NonFinite;
}

/** The camera and the background that the options ask for. */
struct PreparedScene {
  scene::PlacedCamera camera;
  eevee::Background background;
};

/** Poses and lights the scene. */
PreparedScene prepare(const RenderOptions &options, FrameSequence &frames, scene::Scene &scene)
{
  frames.choose_animations(scene);
  frames.pose(scene, 0);
  const scene::PlacedCamera camera = find_camera(scene, options);
  using Kind = eevee::Background::Kind;
  eevee::Background usual;
  if (options.world.world.empty() && scene.world()) {
    usual.kind = Kind::World;
  }
  if (light_by_world(scene, camera, options.world) && options.is_png()) {
    usual = {Kind::Color, glm::vec3(0.6F)};
  }
  return {camera, background_of(options.background, usual)};
}

/** Prints the results of a picture that was asked for as a whole. */
void print_result(const RenderOptions &options, const RenderResult &result, const Chooser *chooser)
{
  print_summary(options, result);
  if (chooser) {
    chooser->print_measured();
  }
  if (options.is_explained) {
    fmt::print("{}", output::printable_text(tree_text(result.report.tree)));
  }
}

/** The settings of the pictures. Changes the number of samples of \a options to theirs. */
eevee::Settings settings_of(RenderOptions &options, const eevee::Background &background, const Chooser *chooser)
{
  if (chooser) {
    options.samples = chooser->choice().sample_count;
  }
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
  return settings;
}

}  // namespace

std::future<ImportedScene> start_import(const RenderOptions &options, const StopRequests &stops)
{
  return std::async(std::launch::async, [&options, &stops] {
    const Clock::time_point start = Clock::now();
    gltf::ImportOptions import_options = options.import_options();
    import_options.progress = [&stops](float) { return !stops.is_stopped(); };
    ImportedScene imported{.scene = import_scene(options.scene, options.world, import_options)};
    if (options.is_part() || options.has_checkpoint || !options.plan_id.empty()) {
      imported.fingerprint = content_fingerprint(imported.scene, options.world);
    }
    imported.seconds = seconds_since(start);
    return imported;
  });
}

Status render_scene(RenderOptions options, gpu::Device &device, ImportedScene &imported, output::Roles &roles,
                    const StopRequests &stops, Clock::time_point start, RenderResult &result)
{
  scene::Scene &scene = imported.scene;
  const glm::ivec2 size_px = options.size_px(device);
  FrameSequence frames(options.frames, options.output);
  const Aov aov(options.aov);
  add_inputs(roles, scene, options.world);
  const auto [camera, background] = prepare(options, frames, scene);
  aov.check(scene);
  std::ranges::copy(aov.warnings(scene), std::back_inserter(scene.warnings));
  print_messages("warning", scene.warnings);

  std::unique_ptr<Chooser> chooser;
  if (options.choice.is_asked()) {
    chooser = std::make_unique<Chooser>(options.choice, device, scene, camera, size_px,
                                        options.engine_settings().has_multiscatter);
    chooser->print_choice();
  }
  const Clock::time_point sync_start = Clock::now();
  const eevee::Settings settings = settings_of(options, background, chooser.get());
  eevee::SceneRenderer renderer(device, scene, size_px, settings);
  renderer.sync();
  renderer.viewport().set_region(options.region());
  const eevee::Inspection inspection = renderer.inspect();
  const eevee::Report before = inspection.report();
  print_messages("warning", before.warnings);
  print_messages("limit", before.limits);
  result.report = before;
  if (options.debug_view.kind == DebugView::Kind::Cascades && !inspection.tinted_sun()) {
    throw std::runtime_error(fmt::format("{}: no sun has a shadow, so there are no cascades", scene.path));
  }
  result.sync_seconds = seconds_since(sync_start);

  Progress progress(options.has_progress_lines, frames.count(), options.samples);
  const Status status =
      render_sequence({options, frames, stops, progress, result, imported.fingerprint}, aov, scene, camera, renderer);
  // Surface functions are compiled by the first picture.
  if (aov.empty()) {
    result.report = inspection.report();
  }
  print_new_messages("warning", result.report.warnings, before.warnings);
  print_new_messages("limit", result.report.limits, before.limits);
  if (!options.has_picture()) {
    print_message("gnomon: the null backend draws nothing: no picture is written\n");
  }
  // The import's warnings have named them.
  result.report.limits.insert(result.report.limits.begin(), scene.limits.begin(), scene.limits.end());
  result.counters = device.counters();
  result.memory_bytes = device.memory_bytes();
  result.total_seconds = seconds_since(start);
  if (chooser && status == Status::Done) {
    chooser->measure(renderer.read_picture(), result.frame_seconds.front());
    const std::vector<std::string> limits = chooser->limits();
    print_messages("limit", limits);
    result.report.limits.insert(result.report.limits.end(), limits.begin(), limits.end());
  }
  write_json(options.json, to_json(options, settings, scene, camera, result, chooser.get()));
  if (status == Status::Done && options.part.empty()) {
    print_result(options, result, chooser.get());
  }
  return status == Status::Done && options.is_strict && !result.report.limits.empty() ? Status::Limit : status;
}

MeasuredScene measure_scene(const RenderOptions &options, gpu::Device *device, output::Roles &roles)
{
  const Clock::time_point start = Clock::now();
  scene::Scene scene = import_scene(options.scene, options.world, options.import_options());
  add_inputs(roles, scene, options.world);
  MeasuredScene measured{content_fingerprint(scene, options.world), {}};
  FrameSequence frames(options.frames, options.output);
  // A plan refuses the options that each of its parts would refuse.
  Aov(options.aov).check(scene);
  static_cast<void>(parse_debug(options.debug));
  static_cast<void>(prepare(options, frames, scene));
  if (!device) {
    return measured;
  }
  eevee::SceneRenderer renderer(*device, scene, options.size_px(*device), options.engine_settings());
  const auto draw_while = [&](const std::function<bool(int drawn)> &condition) {
    renderer.sync();
    const int count = renderer.draw(find_camera(scene, options), {.progress = condition});
    device->finish();
    return count;
  };
  // The driver compiles programs for the first sample of a process.
  draw_while([](int) { return false; });
  measured.cost.start_seconds = seconds_since(start);
  const Clock::time_point draw_start = Clock::now();
  // Another frame, for which shadows are drawn again.
  frames.pose(scene, frames.count() / 2);
  // The first samples of a frame take longer than the others.
  constexpr int sample_count_min = 4;
  constexpr double seconds_min = 1.0;
  const int sample_count = draw_while([&](int drawn) {
    // Recording commands may take less time than drawing.
    device->finish();
    return drawn < sample_count_min || seconds_since(draw_start) < seconds_min;
  });
  measured.cost.sample_seconds = seconds_since(draw_start) / sample_count;
  return measured;
}

}  // namespace gnomon::cli
