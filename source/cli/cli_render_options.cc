// SPDX-License-Identifier: MIT
#include "cli_render_options.hh"

#include "cli.hh"
#include "cli_aov.hh"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

namespace gnomon::cli {

namespace {

/** Values of `--view`. */
const std::map<std::string, draw::ViewTransform> view_transforms = {{"standard", draw::ViewTransform::Standard},
                                                                    {"raw", draw::ViewTransform::Raw},
                                                                    {"agx", draw::ViewTransform::Agx},
                                                                    {"pbr-neutral", draw::ViewTransform::PbrNeutral}};

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

/** Sets what the options say in \a settings, which offline_settings has chosen. */
void set_shadow_options(const RenderOptions &options, eevee::ShadowSettings &settings)
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
  settings.kind = kinds.at(options.shadow);
  settings.esm.kernel = kernels.at(options.esm);
  settings.pcf = parse_pcf(options.pcf);
  settings.cascades.count = options.cascades;
  settings.cascades.lambda = options.cascade_lambda;
  if (options.cascade_range != "auto") {
    settings.is_fitted_to_depth = options.cascade_range == "depth";
  }
  settings.layer_pass = passes.at(options.cube_pass);
  settings.caster_faces = faces.at(options.casters);
  settings.memory_bytes_max = std::size_t(options.shadow_memory) << 20U;
  if (options.shadow_size > 0) {
    settings.cube_size_px = options.shadow_size;
    settings.map_size_px = options.shadow_size;
    settings.esm.size_px = std::clamp(options.shadow_size, 4, 8192);
    settings.cascades.can_resize = false;
  }
}

}  // namespace

/** Two numbers from 0 with \a separator between them. Empty for any other text. */
static std::optional<glm::ivec2> parse_pair(std::string_view text, char separator)
{
  glm::ivec2 pair{0};
  const char *end = text.data() + text.size();
  const auto [after_first, first_error] = std::from_chars(text.data(), end, pair.x);
  if (first_error != std::errc() || after_first == end || *after_first != separator) {
    return std::nullopt;
  }
  const auto [after_second, second_error] = std::from_chars(after_first + 1, end, pair.y);
  if (second_error != std::errc() || after_second != end || pair.x < 0 || pair.y < 0) {
    return std::nullopt;
  }
  return pair;
}

glm::ivec2 RenderOptions::size_px() const
{
  const std::optional<glm::ivec2> pixels = parse_pair(size, 'x');
  if (!pixels || pixels->x < 1 || pixels->y < 1) {
    throw UsageError(fmt::format("--size '{}' is not WIDTHxHEIGHT in pixels", size));
  }
  return *pixels;
}

gpu::Rectangle RenderOptions::region() const
{
  const glm::ivec2 whole_px = size_px();
  if (tile.empty()) {
    return {{0, 0}, whole_px};
  }
  const std::optional<glm::ivec2> part = parse_pair(tile, '/');
  if (!part || part->x < 1 || part->x > part->y || part->y > whole_px.y) {
    throw UsageError(fmt::format("--tile '{}' is not I/N with I from 1 to N and N up to the {} rows of the picture",
                                 tile, whole_px.y));
  }
  const auto row_of = [&](int index) { return int(std::int64_t(whole_px.y) * index / part->y); };
  const int top = row_of(part->x - 1);
  const int end = row_of(part->x);
  return {{0, whole_px.y - end}, {whole_px.x, end - top}};
}

glm::ivec2 RenderOptions::sample_bounds() const
{
  if (sample_range.empty()) {
    return {0, samples - 1};
  }
  const std::optional<glm::ivec2> bounds = parse_pair(sample_range, '-');
  if (!bounds || bounds->x > bounds->y || bounds->y >= samples) {
    throw UsageError(fmt::format("--sample-range '{}' is not A-B with A up to B, and B less than the {} samples",
                                 sample_range, samples));
  }
  return *bounds;
}

bool RenderOptions::is_png() const
{
  return std::filesystem::path(output).extension() == ".png";
}

draw::ViewTransform RenderOptions::view_transform() const
{
  return view_transforms.at(view);
}

void RenderOptions::check() const
{
  if (!aov.empty() && is_png()) {
    throw UsageError("--aov writes layers of an EXR file; a PNG has none");
  }
  if (!std::isfinite(exposure)) {
    throw UsageError(fmt::format("--exposure {} is not a number of stops", exposure));
  }
  if (!std::isfinite(cascade_lambda)) {
    throw UsageError(fmt::format("--cascade-lambda {} is not from 0 to 1", cascade_lambda));
  }
  if (choice.is_asked() && backend != "gl") {
    throw UsageError("--max-error and --max-time measure a rendered picture and need --backend gl");
  }
  if (!choice.report_folder.empty() && !choice.is_asked()) {
    throw UsageError("--report needs --max-error or --max-time");
  }
  if (output.empty() && backend == "gl") {
    throw UsageError("-o OUT.exr or -o OUT.png is required");
  }
  if (is_part() && (is_png() || !debug.empty() || !aov.empty() || frames.is_resumed)) {
    throw UsageError(
        "--tile and --sample-range write parts of a picture to OUT.exr, without --debug, --aov and --resume");
  }
  if (noise_threshold > 0.0F && (is_part() || !aov.empty() || choice.is_asked())) {
    throw UsageError(
        "--noise-threshold compares pixels of a whole picture, without --tile, --sample-range, --aov, --max-error and "
        "--max-time");
  }
  static_cast<void>(region());
  static_cast<void>(sample_bounds());
  if (!output.empty() && !is_png() && std::filesystem::path(output).extension() != ".exr") {
    throw UsageError(fmt::format("-o '{}' ends in neither .exr nor .png", output));
  }
}

eevee::Settings RenderOptions::engine_settings() const
{
  eevee::Settings settings = eevee::offline_settings(samples);
  set_shadow_options(*this, settings.shadow);
  // The number of samples that fit into a time is not known beforehand.
  settings.sample_count = std::isfinite(seconds_max) ? 0 : samples;
  if (!sample_range.empty()) {
    const glm::ivec2 bounds = sample_bounds();
    settings.sample_first = bounds.x;
    settings.sample_end = bounds.y + 1;
  }
  settings.seed = seed;
  settings.has_multiscatter = specular == "multi";
  settings.light_threshold = light_threshold;
  settings.emissive_point_count = emissive_points;
  settings.noise_threshold = noise_threshold;
  settings.has_cascade_tint = debug_view.kind == DebugView::Kind::Cascades;
  settings.has_surfaces = is_density_shown();
  settings.is_timed = !json.empty() || is_explained;
  return settings;
}

/**
 * The options with their values, but for those that parts of one picture may differ in: what is written beside it,
 * which part of it is drawn, and how it is checked. A new option is compared unless it is named here.
 */
static std::string settings_text(const CLI::App &command)
{
  static const std::set<std::string> not_compared = {
      // Metadata of their own are compared: the scene's name without its folder, and the number of the frame.
      "scene",    "--frames", "--help",           "--output", "--json",         "--trace",   "--explain",   "--strict",
      "--resume", "--repeat", "--redraw-shadows", "--tile",   "--sample-range", "--backend", "--only-below"};
  std::string text;
  for (const CLI::Option *option : command.get_options()) {
    const std::string name = option->get_name();
    if (not_compared.contains(name)) {
      continue;
    }
    std::string value = option->count() > 0 ? CLI::detail::join(option->results(), " ") : option->get_default_str();
    // A number may be spelt in several ways.
    double number = 0.0;
    const char *end = value.data() + value.size();
    if (const auto [after, error] = std::from_chars(value.data(), end, number); error == std::errc() && after == end) {
      value = fmt::format("{}", number);
    }
    const bool is_word = !value.empty() && value.find_first_of(" '") == value.npos;
    text += fmt::format("{}{} {}", text.empty() ? "" : " ", name, is_word ? value : fmt::format("'{}'", value));
  }
  return text;
}

void add_specular_option(CLI::App &command, std::string &specular)
{
  command
      .add_option(
          "--specular", specular,
          "Reflections of light among microfacets: single, as glTF's model, or multi: rough surfaces lose no light")
      ->capture_default_str()
      ->check(CLI::IsMember({"single", "multi"}));
}

void add_render_options(CLI::App &command, RenderOptions &options)
{
  command.add_option("scene", options.scene, "glTF 2.0 file")->required();
  command.add_option("-o,--output", options.output,
                     "OUT.exr: scene-linear floats; OUT.png: display colours after the view transform");
  command.add_option("--size", options.size, "WIDTHxHEIGHT, pixels")->capture_default_str();
  command.add_option("--camera", options.camera, "Name of the camera (default: the first)");
  command.add_option("--variant", options.variant, "Name of the variant of materials (KHR_materials_variants)");
  command
      .add_option("--texture-size-max", options.texture_size_max,
                  "Most texels along an edge of a texture; larger ones are reduced (default: no limit)")
      ->check(CLI::Range(1, 1 << 20));
  add_only_below_option(command, options.only_below);
  CLI::Option *samples = command.add_option("--samples", options.samples, "Samples per pixel")
                             ->capture_default_str()
                             ->check(CLI::Range(1, 65536));
  CLI::Option *time_limit =
      command
          .add_option(
              "--time-limit", options.seconds_max,
              "Time for each picture, s: draw samples until it has passed; --samples, if given, is an upper limit")
          ->check(CLI::Range(1e-3, 1e9));
  command
      .add_option("--sample-range", options.sample_range,
                  "Draw only the samples A-B of --samples, counted from 0; `gnomon merge` joins the parts")
      ->excludes(time_limit);
  command
      .add_option("--tile", options.tile,
                  "Draw only the I-th of N strips of the picture, I/N, counted from 1 at the top; `gnomon merge` "
                  "joins them")
      ->excludes(time_limit);
  CLI::Option *frames =
      command.add_option("--frames", options.frames.range,
                         "Frames A-B or A of an animation; the frame number replaces the # characters in -o");
  command.add_option("--fps", options.frames.frames_per_second, "Frames per second of an animation; frame 0 is at 0 s")
      ->needs(frames)
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1e6));
  command.add_option("--animation", options.frames.animation, "Name of the animation (default: the first)")
      ->needs(frames);
  command
      .add_flag("--resume", options.frames.is_resumed, "Skip frames whose files are complete and have the same size")
      ->needs(frames);
  command.add_option("--repeat", options.repeat, "Number of times to render the picture, to measure its time")
      ->excludes(frames)
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  command.add_flag("--redraw-shadows", options.redraws_shadows,
                   "With --repeat: draw the shadows of each picture anew, as after an edit of the scene");
  command
      .add_option("--shadow", options.shadow,
                  "Shadows of lamps without gnomon_shadow: none, hard, pcf, esm, evsm; none disables all shadows")
      ->capture_default_str()
      ->check(CLI::IsMember({"none", "hard", "pcf", "esm", "evsm"}));
  command
      .add_option("--shadow-size", options.shadow_size,
                  "Width of cube faces, maps and octahedral layers, pixels (default: 1024, 2048, 512; 768, 1024, "
                  "512 with one sample; twice that with at least 16 samples)")
      ->check(CLI::Range(1, 16384));
  command
      .add_option("--pcf", options.pcf, "Filter kernel of --shadow pcf: 1, 3x3, 5x5, or disk:N for N lookups on a disk")
      ->capture_default_str();
  command.add_option("--esm", options.esm, "Filter taps of --shadow esm and evsm: 4, 32, or separable")
      ->capture_default_str()
      ->check(CLI::IsMember({"4", "32", "separable"}));
  command
      .add_option("--cascades", options.cascades,
                  "Shadow maps of each sun; 0: as many as needed for texels no larger than pixels")
      ->capture_default_str()
      ->check(CLI::Range(0, eevee::cascade_count_max));
  command
      .add_option("--cascade-lambda", options.cascade_lambda,
                  "Distribution of the cascades over the distance: 0 even, 1 logarithmic")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  command
      .add_option("--cascade-range", options.cascade_range,
                  "What shadow maps cover: view, the scene within the camera's frustum (cascades) or around the lamp; "
                  "depth, the visible surfaces; auto, depth with at least 16 samples")
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "view", "depth"}));
  command
      .add_option("--cube-pass", options.cube_pass,
                  "Drawing of the layers of a lamp: six (one pass for each), geometry or layered (one pass for all), "
                  "best")
      ->capture_default_str()
      ->check(CLI::IsMember({"best", "six", "geometry", "layered"}));
  command.add_option("--casters", options.casters, "Faces of one-sided materials that cast shadows: all, front, back")
      ->capture_default_str()
      ->check(CLI::IsMember({"all", "front", "back"}));
  command
      .add_option("--shadow-memory", options.shadow_memory,
                  "Maximum memory of shadow layers, MiB; their sizes are reduced to fit")
      ->capture_default_str()
      ->check(CLI::Range(1, 1 << 20));
  add_specular_option(command, options.specular);
  command
      .add_option("--light-threshold", options.light_threshold,
                  "Irradiance, W/m2, that may be left out of the light of each point and spot lamp")
      ->capture_default_str()
      ->check(CLI::Range(0.0F, 1e30F));
  command
      .add_option(
          "--noise-threshold", options.noise_threshold,
          "After the first samples, draw further ones only for pixels that differ from a neighbour by more than "
          "this, relative to the square root of their brightness; 0: all pixels get all samples")
      ->capture_default_str()
      ->check(CLI::Range(0.0F, 1e3F));
  command
      .add_option("--emissive-points", options.emissive_points,
                  "Points of emissive surfaces that light other surfaces in each of several samples; 0: none do")
      ->capture_default_str()
      ->check(CLI::Range(0, eevee::emissive_point_max));
  command.add_option(
      "--debug", options.debug,
      "shadow:LAMP[:LAYER]: distances in the layers of a shadow (the face of a cube: 0 to 5 or +X, -X, "
      "..., a cascade from 0, octahedral, all) instead of the picture; cascades: the picture, tinted by "
      "the cascade that a pixel reads; density:LAMP: the picture, coloured by the size of shadow texels, "
      "from red (as large as 4 pixels) through green (a pixel) to blue (a quarter)");
  command
      .add_option("--aov", options.aov,
                  fmt::format("Layers of the EXR beside the picture, separated by commas: {}", aov_names()))
      ->excludes(command.get_option("--debug"));
  command.add_option("--view", options.view, "View transform of a PNG: standard, raw, agx, pbr-neutral")
      ->capture_default_str()
      ->check(CLI::IsMember(view_transforms));
  command.add_option("--exposure", options.exposure, "Exposure of a PNG, stops")
      ->capture_default_str()
      ->check(CLI::Range(-64.0, 64.0));
  command.add_option("--backend", options.backend, "gl, or null: record without a driver and draw nothing")
      ->capture_default_str()
      ->check(CLI::IsMember({"gl", "null"}));
  command.add_flag("--explain", options.is_explained, "Print the parts of the frame, and the parts that were left out");
  command.add_option("--json", options.json,
                     "Write times, counters, limits, and the parts that were made and left out");
  command.add_option(
      "--trace", options.trace,
      "Write the times of the parts of the process, in Chrome's trace format (chrome://tracing, Perfetto)");
  add_world_options(command, options.world);
  add_background_option(command, options.background);
  CLI::Option *max_error =
      command
          .add_option("--max-error", options.choice.error_max,
                      "Choose the fastest shadows and samples with at most this RMSE against ray tracing")
          ->check(CLI::Range(1e-6, 1e6));
  CLI::Option *max_time =
      command
          .add_option("--max-time", options.choice.milliseconds_max,
                      "Choose the most exact shadows and samples within this time for a picture, ms")
          ->check(CLI::Range(1e-3, 1e9))
          ->excludes(max_error);
  // These options set what is chosen automatically, or change the picture so that its error cannot be measured.
  for (const char *name : {"--samples", "--time-limit", "--shadow", "--shadow-size", "--pcf", "--esm", "--cascades",
                           "--cascade-lambda", "--cascade-range", "--cube-pass", "--casters", "--shadow-memory",
                           "--debug", "--frames", "--background", "--sample-range", "--tile", "--aov"}) {
    max_error->excludes(command.get_option(name));
    max_time->excludes(command.get_option(name));
  }
  command.add_option("--report", options.choice.report_folder,
                     "Folder of gnomon report to choose from (default: render a pilot)");
  command.add_flag("--strict", options.is_strict, "End with status 4 if a limit was hit");
  command.add_option("--seed", options.seed, "Seed of the sample pattern")->capture_default_str();
  command.parse_complete_callback([&options, &command, samples, time_limit] {
    options.settings_text = settings_text(command);
    if (time_limit->count() > 0 && samples->count() == 0) {
      options.samples = 0;
    }
  });
}

}  // namespace gnomon::cli
