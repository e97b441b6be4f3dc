// SPDX-License-Identifier: MIT
#include "cli_render_options.hh"

#include "cli.hh"
#include "cli_aov.hh"
#include "cli_device.hh"
#include "gpu_device.hh"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <string>

namespace gnomon::cli {

namespace {

/** Options that do not go together, and the sentence that says so, in the help and in messages. */
struct Exclusion {
  /** One of `first` and one of `second` were given. Both are empty if `is_broken` decides. */
  std::vector<std::string> first{};
  std::vector<std::string> second{};
  /** Decides by values of options, such as the extension of a file. */
  bool (*is_broken)(const RenderOptions &options) = nullptr;
  std::string sentence{};
};

bool compares_pixels(const RenderOptions &options)
{
  return options.engine_settings().noise_threshold > 0.0F;
}

std::vector<Exclusion> exclusions()
{
  // Options that they choose themselves, and options that change a picture so that its error cannot be measured.
  std::vector<std::string> chosen = {"--samples",    "--time-limit", "--debug",        "--frames",
                                     "--background", "--tile",       "--sample-range", "--aov"};
  const std::string chosen_sentence = fmt::format(
      "--max-error and --max-time choose the samples and shadows of one whole picture, without {} and the "
      "options of shadows.",
      fmt::join(chosen, ", "));
  eevee::ShadowSettings::for_each_property([&](const auto &row) {
    if (!row.option.empty()) {
      chosen.push_back("--" + std::string(row.option));
    }
  });
  return {{.is_broken =
               [](const RenderOptions &options) {
                 const bool is_resumed = options.frames.is_resumed && options.plan_id.empty();
                 return options.is_part() &&
                        (options.is_png() || !options.debug.empty() || !options.aov.empty() || is_resumed);
               },
           .sentence =
               "--tile and --sample-range write parts of a picture to OUT.exr, without --debug, --aov and --resume."},
          {.is_broken =
               [](const RenderOptions &options) {
                 return options.has_checkpoint &&
                        (options.is_png() || !options.debug.empty() || !options.aov.empty() ||
                         compares_pixels(options) || options.choice.is_asked() || std::isfinite(options.seconds_max));
               },
           .sentence = "--checkpoint writes a part of a picture to OUT.checkpoint.exr, without a PNG, --debug, --aov, "
                       "--noise-threshold, --time-limit, --max-error and --max-time."},
          {.is_broken =
               [](const RenderOptions &options) {
                 const bool is_whole = !options.is_part() && options.aov.empty() && !options.choice.is_asked();
                 return !is_whole && compares_pixels(options);
               },
           .sentence = "--noise-threshold above 0 compares pixels of a whole picture, without --tile, --sample-range, "
                       "--aov, --max-error and --max-time."},
          {.first = {"--max-error"},
           .second = {"--max-time"},
           .sentence = "--max-error and --max-time exclude each other."},
          {.first = {"--max-error", "--max-time"}, .second = chosen, .sentence = chosen_sentence},
          {.first = {"--time-limit"},
           .second = {"--tile", "--sample-range"},
           .sentence = "--time-limit excludes --tile and --sample-range, whose parts need a known number of samples."},
          {.first = {"--repeat"}, .second = {"--frames"}, .sentence = "--repeat excludes --frames."},
          {.first = {"--shutter"},
           .second = {"--aov", "--debug"},
           .sentence = "--shutter excludes --aov and --debug, which show one time."},
          {.first = {"--debug"}, .second = {"--aov"}, .sentence = "--debug excludes --aov."}};
}

/** false also where the command does not have the option. */
bool is_given(const CLI::App &command, const std::string &name)
{
  const CLI::Option *option = command.get_option_no_throw(name);
  return option && option->count() > 0;
}

/** \throws UsageError */
void check_exclusions(const CLI::App &command)
{
  const auto given = [&](const std::vector<std::string> &names) {
    return std::ranges::find_if(names, [&](const std::string &name) { return is_given(command, name); });
  };
  for (const Exclusion &exclusion : exclusions()) {
    const auto first = given(exclusion.first);
    const auto second = given(exclusion.second);
    if (first != exclusion.first.end() && second != exclusion.second.end()) {
      throw UsageError(fmt::format("{} and {} were given. {}", *first, *second, exclusion.sentence));
    }
  }
}

}  // namespace

std::string exclusions_text(const CLI::App &command)
{
  std::string text = "Options that do not go together:";
  for (const Exclusion &exclusion : exclusions()) {
    const std::string &sentence = exclusion.sentence;
    bool has_all = true;
    for (std::size_t at = 0; (at = sentence.find("--", at)) != sentence.npos; at++) {
      has_all &= command.get_option_no_throw(sentence.substr(at, sentence.find_first_of(" ,.", at) - at)) != nullptr;
    }
    text += has_all ? "\n  " + sentence : "";
  }
  return text;
}

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

glm::ivec2 RenderOptions::size_px(const gpu::Device &device) const
{
  const glm::ivec2 pixels = size_px();
  if (const int most = device.limits().texture_size_max; pixels.x > most || pixels.y > most) {
    throw UsageError(fmt::format("--size '{}' is not from 1x1 to {}x{} pixels, the largest picture of the device", size,
                                 most, most));
  }
  return pixels;
}

gpu::Rectangle RenderOptions::region() const
{
  const glm::ivec2 whole_px = size_px();
  if (tile.empty()) {
    return {{0, 0}, whole_px};
  }
  const std::optional<glm::ivec2> strip = parse_pair(tile, '/');
  if (!strip || strip->x < 1 || strip->x > strip->y || strip->y > whole_px.y) {
    throw UsageError(fmt::format("--tile '{}' is not I/N with I from 1 to N and N up to the {} rows of the picture",
                                 tile, whole_px.y));
  }
  const auto row_of = [&](int index) { return int(std::int64_t(whole_px.y) * index / strip->y); };
  const int top = row_of(strip->x - 1);
  const int end = row_of(strip->x);
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

render_scene::Display RenderOptions::display() const
{
  return changed(render_scene::Display(), display_changes);
}

gltf::ImportOptions RenderOptions::import_options() const
{
  return changed(gltf::ImportOptions{.only_below = only_below}, import_changes);
}

void RenderOptions::check() const
{
  if (!aov.empty() && is_png()) {
    throw UsageError("--aov writes layers of an EXR file; a PNG has none");
  }
  if (choice.is_asked() && !has_picture()) {
    throw UsageError("--max-error and --max-time measure a rendered picture, and --backend null has none");
  }
  if (!choice.report_folder.empty() && !choice.is_asked()) {
    throw UsageError("--report needs --max-error or --max-time");
  }
  if (output.empty() && has_picture()) {
    throw UsageError("-o OUT.exr or -o OUT.png is required");
  }
  for (const Exclusion &exclusion : exclusions()) {
    if (exclusion.is_broken != nullptr && exclusion.is_broken(*this)) {
      throw UsageError(exclusion.sentence);
    }
  }
  static_cast<void>(region());
  static_cast<void>(sample_bounds());
  if (!output.empty() && !is_png() && std::filesystem::path(output).extension() != ".exr") {
    throw UsageError(fmt::format("-o '{}' ends in neither .exr nor .png", output));
  }
}

eevee::Settings RenderOptions::engine_settings() const
{
  eevee::Settings settings = changed(eevee::offline_settings(samples), changes);
  // The number of samples that fit into a time is not known beforehand.
  settings.sample_count = std::isfinite(seconds_max) ? 0 : samples;
  if (!sample_range.empty()) {
    const glm::ivec2 bounds = sample_bounds();
    settings.sample_first = bounds.x;
    settings.sample_end = bounds.y + 1;
  }
  settings.has_cascade_tint = debug_view.kind == DebugView::Kind::Cascades;
  settings.has_surfaces = is_density_shown();
  settings.is_timed = !json.empty() || is_explained;
  return settings;
}

/** \a text, of which a number or a color may be spelt in several ways. \a type: of the option */
static std::string plain_text(const std::string &text, const std::string &type)
{
  std::int64_t whole = 0;
  double number = 0.0;
  if (type.starts_with("INT") && CLI::detail::lexical_cast(text, whole)) {
    return std::to_string(whole);
  }
  if (type.starts_with("FLOAT") && CLI::detail::lexical_cast(text, number)) {
    return fmt::format("{}", number);
  }
  const std::optional<glm::vec3> color = type.starts_with("TEXT") ? parse_color(text) : std::nullopt;
  return color ? fmt::format("{},{},{}", color->r, color->g, color->b) : text;
}

/** Calls \a visit with each row of settings that an option of `gnomon render` sets. */
template <typename Visit>
static void for_each_row(const Visit &visit)
{
  eevee::Settings::for_each_property(visit);
  eevee::ShadowSettings::for_each_property(visit);
  render_scene::Display::for_each_property(visit);
  gltf::ImportOptions::for_each_property(visit);
  scene::Camera::for_each_property(visit);
}

static std::string option_text(std::string_view name, const std::string &value)
{
  const bool is_word = !value.empty() && value.find_first_of(" '") == value.npos;
  return fmt::format(" --{} {}", name, is_word ? value : fmt::format("'{}'", value));
}

/**
 * The options without a row of settings, with their values, but for those that parts of one picture may differ in: what
 * is written beside it, which part of it is drawn, and how it is checked. A new option is compared unless it is named
 * here.
 */
static std::string given_text(const CLI::App &command)
{
  std::set<std::string> left_out(process_options.begin(), process_options.end());
  // Metadata of their own are compared: the scene's name without its folder, the camera, and the number of the frame.
  left_out.insert({"scene", "--camera", "--frames", "--step", "--help", "--strict", "--only-below"});
  for_each_row([&](const auto &row) { left_out.insert("--" + std::string(row.option)); });
  std::string text;
  for (const CLI::Option *option : command.get_options()) {
    const std::string name = option->get_name();
    if (left_out.contains(name)) {
      continue;
    }
    std::string value = option->count() > 0 ? CLI::detail::join(option->results(), " ") : option->get_default_str();
    if (name == "--world") {
      // Its folder may differ between machines. Its content is compared, too.
      value = std::filesystem::path(value).filename().string();
    }
    text += option_text(name.substr(2), plain_text(value, option->get_type_name()));
  }
  return text;
}

static std::string background_text(const eevee::Background &background)
{
  using Kind = eevee::Background::Kind;
  const glm::vec3 color = background.color;
  return background.kind == Kind::Color   ? fmt::format("{},{},{}", color.r, color.g, color.b)
         : background.kind == Kind::World ? "world"
                                          : "none";
}

/** The rows of \a part that make the picture, as options with all digits. */
template <typename T>
static std::string values_text(const T &part)
{
  std::string text;
  T::for_each_property([&](const auto &row) {
    using Value = typename std::decay_t<decltype(row)>::Value;
    if (row.option.empty() || !row.makes_picture) {
      return;
    }
    const Value &value = row.access(part);
    if constexpr (std::is_same_v<Value, eevee::Background>) {
      text += option_text(row.option, background_text(value));
    }
    else if constexpr (std::is_floating_point_v<Value>) {
      // Without the sign of a zero.
      text +=
          option_text(row.option, fmt::format("{}", Value(double(value) * scene::shown_unit(row).factor) + Value(0)));
    }
    else {
      text += option_text(row.option, default_text(row, value));
    }
  });
  return text;
}

std::string RenderOptions::settings_text(eevee::Settings settings, const scene::Camera &lens) const
{
  settings.emissive_point_count = settings.emissive_points();
  return (given_text + values_text(settings) + values_text(settings.shadow) + values_text(display()) +
          values_text(import_options()) + values_text(lens))
      .substr(1);
}

std::vector<Defaults<eevee::Settings>> setting_defaults()
{
  return {{"", eevee::offline_settings(2)},
          {"with one sample", eevee::offline_settings(1)},
          {"with at least 16 samples", eevee::offline_settings(16)}};
}

/** The number and the row of Settings::sample_count. */
static CLI::Option *add_samples_option(CLI::App &command, int &samples)
{
  CLI::Option *option = nullptr;
  eevee::Settings::for_each_property([&](const auto &row) {
    if (row.option == "samples") {
      option = command.add_option("--samples", samples, "Samples per pixel")
                   ->capture_default_str()
                   ->check(CLI::Range(int(row.min), int(row.max)));
    }
  });
  return option;
}

/** The part of settings that is all of them. */
constexpr auto whole_part = [](auto &settings) -> auto &
{
  return settings;
};

/** \return the option --samples */
static CLI::Option *add_picture_options(CLI::App &command, RenderOptions &options)
{
  command.option_defaults()->group("Picture");
  command.add_option("-o,--output", options.output,
                     "OUT.exr: scene-linear floats; OUT.png: display colours after the view transform; {scene} in the "
                     "name is replaced by that of the scene");
  command.add_option("--size", options.size, "WIDTHxHEIGHT, pixels")->capture_default_str();
  command.add_option("--camera", options.camera, "Name of the camera (default: the first)");
  SettingOptions<scene::Camera> camera(std::vector<Defaults<scene::Camera>>{});
  camera.take<scene::Camera>(whole_part);
  camera.add_to(command, "Picture", options.camera_changes);
  CLI::Option *samples = add_samples_option(command, options.samples);
  command
      .add_option("--time-limit", options.seconds_max,
                  "Time for each picture, s: draw samples until it has passed; --samples, if given, is an upper limit")
      ->check(number_range(1e-3, 1e9));
  SettingOptions<eevee::Settings> settings(setting_defaults());
  settings.take<eevee::Settings>(whole_part, [](std::string_view option) { return option != "samples"; });
  settings.add_to(command, "Picture", options.changes);
  SettingOptions<render_scene::Display> display;
  display.take<render_scene::Display>(whole_part);
  display.add_to(command, "Picture", options.display_changes);
  command.add_option(
      "--debug", options.debug,
      "shadow:LAMP[:LAYER]: distances in the layers of a shadow (the face of a cube: 0 to 5 or +X, -X, "
      "..., a cascade from 0, octahedral, all) instead of the picture; cascades: the picture, tinted by "
      "the cascade that a pixel reads; density:LAMP: the picture, coloured by the size of shadow texels, "
      "from red (as large as 4 pixels) through green (a pixel) to blue (a quarter)");
  command.add_option("--aov", options.aov,
                     fmt::format("Layers of the EXR beside the picture, separated by commas: {}", aov_names()));
  return samples;
}

static void add_scene_options(CLI::App &command, RenderOptions &options)
{
  command.option_defaults()->group("Scene");
  SettingOptions<gltf::ImportOptions> import;
  import.take<gltf::ImportOptions>(whole_part);
  import.add_to(command, "Scene", options.import_changes);
  add_only_below_option(command, options.only_below);
  add_world_options(command, options.world);
  add_background_option(command, options.background);
}

static void add_animation_options(CLI::App &command, RenderOptions &options)
{
  command.option_defaults()->group("Animation");
  CLI::Option *frames =
      command.add_option("--frames", options.frames.range,
                         "Frames A-B or A of an animation; the frame number replaces the # characters in -o");
  command.add_option("--step", options.frames.step, "From one frame of --frames to the next")
      ->needs(frames)
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  command.add_option("--fps", options.frames.frames_per_second, "Frames per second of an animation; frame 0 is at 0 s")
      ->needs(frames)
      ->capture_default_str()
      ->check(number_range(1e-3, 1e6));
  command
      .add_option(
          "--shutter", options.frames.shutter,
          "Part of the time of a frame for which the shutter is open, in the middle of which the frame is: motion "
          "blur")
      ->needs(frames)
      ->capture_default_str()
      ->check(number_range(0.0, 100.0));
  command
      .add_option("--animation", options.frames.animations,
                  "Name of an animation, may be given several times; or all (default: those that animate other things "
                  "than those before them)")
      ->needs(frames)
      ->allow_extra_args(false);
  command
      .add_flag("--resume", options.frames.is_resumed, "Skip frames whose files are complete and have the same size")
      ->needs(frames);
}

static void add_part_and_choice_options(CLI::App &command, RenderOptions &options)
{
  command.option_defaults()->group("Parts of a picture");
  command.add_option("--sample-range", options.sample_range,
                     "Draw only the samples A-B of --samples, counted from 0; `gnomon merge` joins the parts");
  command.add_option("--tile", options.tile,
                     "Draw only the I-th of N strips of the picture, I/N, counted from 1 at the top; `gnomon merge` "
                     "joins them");

  command.option_defaults()->group("Choice of samples and shadows");
  command
      .add_option("--max-error", options.choice.error_max,
                  "Choose the fastest shadows and samples with at most this RMSE against ray tracing")
      ->check(number_range(1e-6, 1e6));
  command
      .add_option("--max-time", options.choice.milliseconds_max,
                  "Choose the most exact shadows and samples within this time for a picture, ms")
      ->check(number_range(1e-3, 1e9));
  command.add_option("--report", options.choice.report_folder,
                     "Folder of gnomon report to choose from (default: render a pilot)");
}

static void add_report_options(CLI::App &command, RenderOptions &options)
{
  command.option_defaults()->group("Reports and measurement");
  command.add_flag("--explain", options.is_explained, "Print the parts of the frame, and the parts that were left out");
  command.add_option("--json", options.json,
                     "Write settings, times, counters, limits, and the parts that were made and left out");
  command.add_option(
      "--trace", options.trace,
      "Write the times of the parts of the process, in Chrome's trace format (chrome://tracing, Perfetto)");
  command.add_flag("--strict", options.is_strict, "End with status 4 if a limit was hit");
  command.add_option("--repeat", options.repeat, "Number of times to render the picture, to measure its time")
      ->capture_default_str()
      ->check(CLI::Range(1, 100000));
  command.add_flag("--redraw-shadows", options.redraws_shadows,
                   "With --repeat: draw the shadows of each picture anew, as after an edit of the scene");
  add_backend_option(command, options.backend, "record without a driver and draw nothing");
}

static void add_farm_options(CLI::App &command, RenderOptions &options)
{
  command.option_defaults()->group("Farms");
  command.add_option("--part", options.part,
                     "PLAN.json:K: render part K of a plan of `gnomon plan`, unless it is complete, with the plan's "
                     "scene and options; prints one line of JSON");
  command
      .add_option("--stop-after", options.stop_seconds,
                  "Time after which the command ends after the current sample, as after SIGTERM, s")
      ->check(number_range(1e-3, 1e9));
  command.add_flag(
      "--checkpoint", options.has_checkpoint,
      "If the command ends early, write the samples drawn so far to OUT.checkpoint.exr for `gnomon merge`");
  command.add_flag("--progress", options.has_progress_lines, "Print lines such as PROGRESS 12.5% on stderr");
}

void add_render_options(CLI::App &command, RenderOptions &options)
{
  command.add_option("scene", options.scenes, "glTF 2.0 file, or several whose pictures have {scene} in their names");
  CLI::Option *samples = add_picture_options(command, options);
  SettingOptions<eevee::Settings> shadows(setting_defaults());
  shadows.take<eevee::ShadowSettings>([](auto &all) -> auto & { return all.shadow; });
  shadows.add_to(command, "Shadows", options.changes);
  add_scene_options(command, options);
  add_animation_options(command, options);
  add_part_and_choice_options(command, options);
  add_report_options(command, options);
  add_farm_options(command, options);
  command.footer(exclusions_text(command));
  command.parse_complete_callback([&options, &command, samples] {
    check_exclusions(command);
    options.given_text = given_text(command);
    if (is_given(command, "--time-limit") && samples->count() == 0) {
      options.samples = 0;
    }
    if (is_given(command, "--shadow-size")) {
      options.changes.emplace_back([](eevee::Settings &picture) { picture.shadow.cascades.can_resize = false; });
    }
  });
}

}  // namespace gnomon::cli
