// SPDX-License-Identifier: MIT
#include "cli.hh"

#include "cli_device.hh"
#include "cli_fingerprint.hh"
#include "cli_origin.hh"
#include "cli_output.hh"
#include "cli_picture.hh"
#include "cli_render_options.hh"
#include "cli_system.hh"
#include "cli_time.hh"
#include "cli_world.hh"

#include "measure_reference.hh"
#include "measure_report.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

struct ReportOptions {
  std::vector<std::string> scenes;
  std::string folder;
  std::vector<int> size = {480, 270};
  int rounds = 3;
  int reference_samples = 64;
  /** Names or labels of techniques; empty for all. */
  std::vector<std::string> techniques;
  WorldOptions world;
  /** has_multiscatter is used. */
  Changes<eevee::Settings> changes;
  fs::path only_below;
  std::string backend = "auto";
};

/** Shows a progress bar on a terminal; silent in a pipe. */
class Progress {
 public:
  explicit Progress(std::size_t count) : count_(count) {}

  void begin_next(const std::string &what)
  {
    show(what);
    done_++;
  }
  void end() const
  {
    if (is_shown_) {
      print_message("\r\033[K");
    }
  }

 private:
  void show(const std::string &what) const
  {
    if (is_shown_) {
      constexpr std::size_t width = 30;
      const std::size_t filled = width * done_ / count_;
      print_message("\r\033[K[{}{}] {}/{}  {:.0f} s  {}", std::string(filled, '#'), std::string(width - filled, '.'),
                    done_, count_, seconds_since(start_), what);
      std::fflush(stderr);
    }
  }

  std::size_t count_;
  std::size_t done_ = 0;
  Clock::time_point start_ = Clock::now();
  bool is_shown_ = stderr_is_terminal();
};

/** The techniques with these names or labels. \throws UsageError naming one that does not exist. */
std::vector<measure::Technique> wanted_techniques(const std::vector<std::string> &names)
{
  const std::vector<measure::Technique> all = measure::report_techniques();
  if (names.empty()) {
    return all;
  }
  const auto is_called = [](const measure::Technique &one, const std::string &name) {
    return one.name == name || measure::label(one) == name;
  };
  for (const std::string &name : names) {
    if (std::ranges::none_of(all, [&](const measure::Technique &one) { return is_called(one, name); })) {
      std::vector<std::string> labels;
      std::ranges::transform(all, std::back_inserter(labels), measure::label);
      throw UsageError(fmt::format("--technique '{}' is not one of '{}'", name, fmt::join(labels, "', '")));
    }
  }
  std::vector<measure::Technique> wanted;
  std::ranges::copy_if(all, std::back_inserter(wanted), [&](const measure::Technique &one) {
    return std::ranges::any_of(names, [&](const std::string &name) { return is_called(one, name); });
  });
  return wanted;
}

/** Whether two reports measure the same work, so that a run can continue. */
bool is_same_work(const measure::SceneReport &one, const measure::SceneReport &other)
{
  return one.name == other.name && one.fingerprint == other.fingerprint &&
         std::ranges::equal(
             one.techniques, other.techniques, {},
             [](const measure::TechniqueReport &report) { return measure::label(report.technique); },
             [](const measure::TechniqueReport &report) { return measure::label(report.technique); });
}

/** A run and its folder. The folder is updated after each measurement, so that an interrupted run can be continued. */
class Run {
 public:
  Run(gpu::Device &device, const ReportOptions &options);

  /** \return number of values that are not finite. */
  std::size_t measure_all();

 private:
  /** A scene with its lamps' own shadow settings, in the world of the options. */
  [[nodiscard]] scene::Scene lit_scene(const std::string &path) const;
  void resume();
  void measure(measure::SceneReport &report);
  void visit(const scene::Scene &scene, const reference::Tracer &tracer, measure::SceneReport &report,
             measure::TechniqueReport &technique);
  void make_reference(const scene::Scene &scene, const reference::Tracer &tracer, measure::SceneReport &report);
  /** Prints the warning once for each scene. */
  void warn(measure::SceneReport &report, const std::string &warning) const;
  void save() const;
  void finish(measure::SceneReport &report) const;
  /** Whether the folder has the pictures that are needed to continue \a report. */
  [[nodiscard]] bool has_pictures(const measure::SceneReport &report) const;
  [[nodiscard]] std::size_t visits_left(const measure::SceneReport &report) const;

  gpu::Device &device_;
  ReportOptions options_;
  fs::path folder_;
  measure::RunReport run_;
  /** The reference of the current scene. */
  std::vector<glm::vec4> reference_;
  double seconds_before_ = 0.0;
  Clock::time_point start_ = Clock::now();
  std::optional<Progress> progress_;
};

Run::Run(gpu::Device &device, const ReportOptions &options)
    : device_(device), options_(options), folder_(options.folder)
{
  const Origin where = origin();
  run_.program = where.program;
  run_.commit = where.commit;
  run_.build = program_fingerprint();
  run_.device = device.description();
  run_.machine = where.machine;
  run_.date = where.date;
  run_.rounds = options.rounds;
  run_.reference_samples = options.reference_samples;
  run_.has_multiscatter = changed(eevee::Settings(), options.changes).has_multiscatter;
  run_.size_px = {options.size[0], options.size[1]};
  const std::vector<measure::Technique> techniques = wanted_techniques(options.techniques);
  output::Roles roles;
  for (const std::string &path : options.scenes) {
    const std::string name = fs::path(path).stem().string();
    if (std::ranges::find(run_.scenes, name, &measure::SceneReport::name) != run_.scenes.end()) {
      throw std::runtime_error(fmt::format("{}: another scene has the same name, '{}'", path, name));
    }
    measure::SceneReport &scene = run_.scenes.emplace_back();
    scene.name = name;
    scene.path = path;
    const scene::Scene lit = lit_scene(path);
    add_inputs(roles, lit, options.world);
    scene.fingerprint = scene_fingerprint(lit);
    scene.world = lit.world() ? world_text(*lit.world()) : "";
    for (const measure::Technique &technique : techniques) {
      measure::TechniqueReport &report = scene.techniques.emplace_back();
      report.technique = technique;
      for (const int sample_count : technique.sample_counts) {
        report.pictures.emplace_back().sample_count = sample_count;
      }
    }
  }
  fs::create_directories(folder_);
  for (const char *name : {"report.json", "report.csv", "report.txt", "index.html"}) {
    roles.add_output(folder_ / name, "-o");
  }
  for (const measure::SceneReport &scene : run_.scenes) {
    roles.add_output(folder_ / measure::reference_file(scene), "-o");
    for (const measure::TechniqueReport &report : scene.techniques) {
      for (const measure::PictureReport &picture : report.pictures) {
        roles.add_output(folder_ / measure::picture_file(scene, report.technique, picture.sample_count), "-o");
      }
    }
  }
  keep_text_from(roles);
  resume();
}

scene::Scene Run::lit_scene(const std::string &path) const
{
  scene::Scene scene = import_scene(path, options_.world, {.only_below = options_.only_below});
  light_by_world(scene, scene.placed_cameras().front(), options_.world);
  return scene;
}

void Run::resume()
{
  const fs::path path = folder_ / "report.json";
  if (!fs::exists(path)) {
    return;
  }
  try {
    output::require_readable(path);
    std::ifstream file(path);
    measure::RunReport before = measure::run_from_json(nlohmann::json::parse(file));
    // Times are comparable only for the same build, machine and driver.
    if (before.build != run_.build || before.device != run_.device || before.machine != run_.machine ||
        before.size_px != run_.size_px || before.rounds != run_.rounds ||
        before.reference_samples != run_.reference_samples || before.has_multiscatter != run_.has_multiscatter) {
      print_message(
          "gnomon: {}: has another build, machine, size, reference, --specular or number of rounds; starting "
          "again\n",
          path.string());
      return;
    }
    for (measure::SceneReport &scene : run_.scenes) {
      const auto same = std::ranges::find_if(
          before.scenes, [&scene](const measure::SceneReport &one) { return is_same_work(one, scene); });
      if (same != before.scenes.end() && has_pictures(*same)) {
        const fs::path scene_path = scene.path;
        scene = std::move(*same);
        scene.path = scene_path;
      }
    }
    run_.date = before.date;
    seconds_before_ = before.seconds;
  }
  catch (const std::exception &error) {
    print_message("gnomon: {}: cannot be continued: {}; starting again\n", path.string(), error.what());
  }
}

bool Run::has_pictures(const measure::SceneReport &report) const
{
  const bool is_finished = visits_left(report) == 0;
  bool is_whole = fs::exists(folder_ / measure::reference_file(report));
  for (const measure::TechniqueReport &technique : report.techniques) {
    for (const measure::PictureReport &picture : technique.pictures) {
      const bool is_wanted = is_finished ? picture.is_on_front : !picture.seconds.empty();
      is_whole &=
          !is_wanted || fs::exists(folder_ / measure::picture_file(report, technique.technique, picture.sample_count));
    }
  }
  return is_whole;
}

std::size_t Run::visits_left(const measure::SceneReport &report) const
{
  std::size_t left = 0;
  for (const measure::TechniqueReport &technique : report.techniques) {
    left += std::size_t(run_.rounds) - technique.step_seconds.size();
  }
  return left;
}

void Run::save() const
{
  measure::RunReport run = run_;
  run.seconds = seconds_before_ + seconds_since(start_);
  write_json(folder_ / "report.json", measure::to_json(run), 1);
}

void Run::make_reference(const scene::Scene &scene, const reference::Tracer &tracer, measure::SceneReport &report)
{
  if (report.reference_seconds > 0.0 && fs::exists(folder_ / measure::reference_file(report))) {
    return;
  }
  progress_->begin_next(report.name + ": reference");
  const Clock::time_point start = Clock::now();
  const measure::ReferencePicture reference = measure::reference_picture(
      tracer, scene.placed_cameras().front(), run_.size_px, options_.reference_samples, run_.has_multiscatter);
  report.reference_noise = reference.noise;
  write_exr(folder_ / measure::reference_file(report), run_.size_px, floats(reference.picture.pixels),
            {{"gnomon:scene", report.path.string()}, {"gnomon:units", "scene-linear radiance, W/(sr m^2)"}});
  report.reference_seconds = seconds_since(start);
}

void Run::warn(measure::SceneReport &report, const std::string &warning) const
{
  if (std::ranges::find(report.warnings, warning) == report.warnings.end()) {
    progress_->end();
    print_message("gnomon: warning: {}: {}\n", report.name, warning);
    report.warnings.push_back(warning);
  }
}

void Run::visit(const scene::Scene &scene, const reference::Tracer &tracer, measure::SceneReport &report,
                measure::TechniqueReport &technique)
{
  const bool is_first = technique.step_seconds.empty();
  progress_->begin_next(fmt::format("{}: {}", report.name, measure::label(technique.technique)));
  measure::TechniqueResult result;
  const measure::TechniqueTimes times = measure::measure_technique(
      device_, scene, technique.technique, run_.size_px, is_first ? &tracer : nullptr, result, run_.has_multiscatter);
  technique.step_seconds.push_back(times.step_seconds);
  for (std::size_t i = 0; i < technique.pictures.size(); i++) {
    technique.pictures[i].seconds.push_back(times.picture_seconds[i]);
  }
  if (is_first) {
    for (const std::string &warning : result.warnings) {
      warn(report, warning);
    }
    technique.lamps = std::move(result.lamps);
    technique.memory_bytes = result.memory_bytes;
    technique.limits = std::move(result.limits);
    technique.lost_shadow_count = result.lost_shadow_count;
    for (std::size_t i = 0; i < technique.pictures.size(); i++) {
      measure::PictureReport &picture = technique.pictures[i];
      picture.error = measure::image_error(run_.size_px, result.pictures[i], reference_);
      write_exr(folder_ / measure::picture_file(report, technique.technique, picture.sample_count), run_.size_px,
                floats(result.pictures[i]),
                {{"gnomon:scene", report.path.string()}, {"gnomon:units", "scene-linear radiance, W/(sr m^2)"}});
    }
  }
}

void Run::measure(measure::SceneReport &report)
{
  if (visits_left(report) > 0) {
    scene::Scene scene = lit_scene(report.path);
    for (const std::string &warning : scene.warnings) {
      warn(report, warning);
    }
    for (const std::string &line : reference::untraced_parts(scene)) {
      warn(report, line);
    }
    measure::remove_shadow_settings(scene);
    const reference::Tracer tracer(scene);
    make_reference(scene, tracer, report);
    reference_ = read_exr(folder_ / measure::reference_file(report), run_.size_px);
    for (int round = 0; round < run_.rounds; round++) {
      for (measure::TechniqueReport &technique : report.techniques) {
        if (technique.step_seconds.size() == std::size_t(round)) {
          visit(scene, tracer, report, technique);
          save();
        }
      }
    }
  }
  finish(report);
}

void Run::finish(measure::SceneReport &report) const
{
  measure::find_front(report);
  for (const measure::TechniqueReport &technique : report.techniques) {
    for (const measure::PictureReport &picture : technique.pictures) {
      if (!picture.is_on_front) {
        fs::remove(folder_ / measure::picture_file(report, technique.technique, picture.sample_count));
      }
    }
  }
}

std::size_t Run::measure_all()
{
  std::size_t left = 0;
  for (const measure::SceneReport &scene : run_.scenes) {
    const std::size_t visits = visits_left(scene);
    left += visits + (visits > 0 && scene.reference_seconds == 0.0 ? 1 : 0);
  }
  progress_.emplace(std::max<std::size_t>(left, 1));
  for (measure::SceneReport &scene : run_.scenes) {
    measure(scene);
  }
  progress_->end();
  run_.seconds = seconds_before_ + seconds_since(start_);
  save();
  output::write_file(folder_ / "report.csv", measure::to_csv(run_));
  const auto read = [this](const std::string &file) { return read_exr(folder_ / file, run_.size_px); };
  output::write_file(folder_ / "index.html", measure::to_html(run_, read, png_bytes));
  std::size_t non_finite = 0;
  std::string text = fmt::format("{} ({}), {}, {}, {}, {}x{}, {} rounds, --specular {}, {:.0f} s\n", run_.program,
                                 run_.commit, run_.date, run_.machine, run_.device, run_.size_px.x, run_.size_px.y,
                                 run_.rounds, measure::specular_text(run_), run_.seconds);
  for (const measure::SceneReport &scene : run_.scenes) {
    text += measure::to_text(scene);
  }
  output::write_file(folder_ / "report.txt", text);
  fmt::print("{}", output::printable_text(text));
  for (const measure::SceneReport &scene : run_.scenes) {
    for (const measure::TechniqueReport &technique : scene.techniques) {
      non_finite += measure::all_lamps(technique.lamps).non_finite_count;
      for (const measure::PictureReport &picture : technique.pictures) {
        non_finite += picture.error.non_finite_count;
      }
      for (const std::string &limit : technique.limits) {
        print_message("gnomon: limit: {}, {}: {}\n", scene.name, measure::label(technique.technique), limit);
      }
    }
  }
  fmt::print("\n{}\n", fs::absolute(folder_ / "index.html").lexically_normal().string());
  return non_finite;
}

Status report(const ReportOptions &options)
{
  if (options.reference_samples % 2 != 0) {
    throw UsageError(fmt::format("--reference-samples {} is not even", options.reference_samples));
  }
  const std::unique_ptr<gpu::Device> device = create_device(options.backend);
  const std::size_t non_finite = Run(*device, options).measure_all();
  if (non_finite > 0) {
    print_message("gnomon: {} values of pictures and shadows are not finite\n", non_finite);
  }
  return non_finite > 0 ? Status::NonFinite : Status::Done;
}

}  // namespace

void add_report(CLI::App &app, Status &status)
{
  auto o = std::make_shared<ReportOptions>();
  CLI::App *command = app.add_subcommand("report", "Error against run time of each shadow technique");
  command->add_option("scenes", o->scenes, "glTF 2.0 files")->required();
  command
      ->add_option("-o,--output", o->folder,
                   "Folder for index.html, report.csv, .json and .txt, and pictures; an interrupted run in it is "
                   "continued")
      ->required();
  command->add_option("--size", o->size, "Width and height of the picture, pixels (default: 480x270)")
      ->delimiter('x')
      ->expected(2)
      ->check(CLI::Range(1, 16384));
  command->add_option("--rounds", o->rounds, "Rounds over all techniques; times are the medians")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000));
  command->add_option("--technique", o->techniques, "Only these, by name or by name and size: \"hard\", \"hard 1024\"")
      ->allow_extra_args(false);
  command
      ->add_option(
          "--reference-samples", o->reference_samples,
          "Rays per pixel of the reference, an even number; the noisiest tenth of the pixels has eight times as many")
      ->capture_default_str()
      ->check(CLI::Range(2, 65536));
  add_world_options(*command, o->world);
  add_only_below_option(*command, o->only_below);
  add_backend_option(*command, o->backend);
  SettingOptions<eevee::Settings> settings;
  settings.take<eevee::Settings>(
      [](auto &whole) -> auto & { return whole; }, [](std::string_view option) { return option == "specular"; });
  settings.add_to(*command, "Options", o->changes);
  command->callback([o, &status] { status = report(*o); });
}

}  // namespace gnomon::cli
