// SPDX-License-Identifier: MIT
#include "cli.hh"

#include "cli_device.hh"
#include "cli_frames.hh"
#include "cli_origin.hh"
#include "cli_output.hh"
#include "cli_render_options.hh"
#include "cli_render_scene.hh"
#include "cli_system.hh"
#include "cli_work_plan.hh"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <string_view>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

struct PlanOptions {
  RenderOptions render;
  std::string plan;
  std::string pictures;
  double target_seconds = 60.0;
  /** 0: measured. */
  double seconds_per_frame = 0.0;
  int tile_count = 1;
};

/** Options of `gnomon render` that each part has of its own. */
constexpr std::array<std::string_view, 3> part_options = {"scene", "--frames", "--step"};

/** The options of \a command that were given and that all parts have in common, for `gnomon render`. */
std::vector<std::string> arguments_of(const CLI::App &command)
{
  CLI::App render;
  RenderOptions unused;
  add_render_options(render, unused);
  std::vector<std::string> arguments;
  for (const CLI::Option *option : command.get_options()) {
    const std::string name = option->get_name();
    const bool is_of_render = render.get_option_no_throw(name) != nullptr;
    if (option->count() == 0 || !is_of_render || std::ranges::find(part_options, name) != part_options.end()) {
      continue;
    }
    if (option->get_items_expected_max() == 0) {
      arguments.push_back(name);
      continue;
    }
    for (const std::string &value : option->results()) {
      // With an equals sign, because a value may begin with a dash.
      arguments.push_back(name + "=" + value);
    }
  }
  return arguments;
}

/** The names of a scene's pictures. \throws UsageError */
std::string pictures_of(const PlanOptions &options, const std::string &scene)
{
  const bool has_frames = !options.render.frames.range.empty();
  if (options.pictures.empty()) {
    return scene_name(has_frames ? "{scene}_####.exr" : "{scene}.exr", scene);
  }
  if (options.render.scenes.size() > 1 && options.pictures.find("{scene}") == options.pictures.npos) {
    throw UsageError(fmt::format("--pictures '{}' has no {{scene}} for the names of the scenes", options.pictures));
  }
  return scene_name(options.pictures, scene);
}

/** Adds the scene at \a path and its parts to \a plan. \a device: nullptr: the costs are those of the options. */
void add_scene(const PlanOptions &options, const std::string &path, gpu::Device *device, output::Roles &roles,
               WorkPlan &plan)
{
  RenderOptions render = options.render;
  render.scene = path;
  render.output = pictures_of(options, path);
  render.check();
  if (fs::path(render.output).extension() != ".exr") {
    throw UsageError(fmt::format("--pictures '{}' does not end in .exr", render.output));
  }
  const FrameSequence frames(render.frames, render.output);
  // The first picture stands for the folder of all frames, because their names differ by the number only.
  const fs::path first = frames.path(0);
  if (first.has_parent_path() && !fs::is_directory(first.parent_path())) {
    throw std::runtime_error(
        fmt::format("--pictures '{}': the folder '{}' does not exist", render.output, first.parent_path().string()));
  }
  for (int i = 0; i < frames.count(); i++) {
    roles.add_output(frames.path(i), "--pictures of " + path);
  }
  const bool can_divide_pictures =
      render.debug.empty() && render.aov.empty() && render.engine_settings().noise_threshold == 0.0F;
  if (options.tile_count > 1 && !can_divide_pictures) {
    throw UsageError("--tiles divides pictures, and --aov, --debug and --noise-threshold need whole ones");
  }
  if (options.tile_count > render.size_px().y) {
    throw UsageError(fmt::format("--tiles {}: the picture has {} rows", options.tile_count, render.size_px().y));
  }
  MeasuredScene measured = measure_scene(render, device, roles);
  if (!device) {
    measured.cost.sample_seconds = options.seconds_per_frame / render.samples;
  }
  plan.scenes.push_back({path, measured.fingerprint, render.output});
  const WorkOfScene work{.scene = plan.scenes.size() - 1,
                         .is_animated = frames.is_animated(),
                         .first_frame = frames.first(),
                         .last_frame = frames.last(),
                         .sample_count = render.samples,
                         .tile_count = options.tile_count,
                         .can_divide_pictures = can_divide_pictures,
                         .pictures = render.output,
                         .cost = measured.cost};
  plan.part_seconds = std::max(plan.part_seconds, add_parts(plan, work, options.target_seconds));
}

Status plan(const PlanOptions &options, const CLI::App &command)
{
  if (options.render.scenes.empty()) {
    throw UsageError("plan: a scene is required");
  }
  if (!options.render.has_picture()) {
    throw UsageError("plan: the parts draw pictures, and --backend null draws none");
  }
  output::Roles roles;
  for (const std::string &scene : options.render.scenes) {
    roles.add_input(scene, "the scene");
  }
  roles.add_output(options.plan, "-o");
  keep_text_from(roles);
  WorkPlan plan{
      .program = program_name(), .arguments = arguments_of(command), .frame_step = options.render.frames.step};
  plan.folder = fs::relative(fs::current_path(), fs::absolute(options.plan).parent_path()).string();
  const std::unique_ptr<gpu::Device> device =
      options.seconds_per_frame > 0.0 ? nullptr : create_device(options.render.backend);
  for (const std::string &path : options.render.scenes) {
    add_scene(options, path, device.get(), roles, plan);
  }
  plan.memory_bytes = device ? memory_bytes_max() : 0;
  write_plan(options.plan, plan);
  fmt::print("{}: {} parts of at most {:.1f} s{}\n", options.plan, plan.parts.size(), plan.part_seconds,
             plan.memory_bytes > 0 ? fmt::format(" and {} MiB", plan.memory_bytes >> 20U) : "");
  return Status::Done;
}

}  // namespace

void add_plan(CLI::App &app, Status &status)
{
  CLI::App *command = app.add_subcommand(
      "plan", "Divide pictures into parts for `gnomon render --part`, which a scheduler starts; options as of render");
  auto options = std::make_shared<PlanOptions>();
  add_render_options(*command, options->render);
  for (const char *name : process_options) {
    command->remove_option(command->get_option(name));
  }
  for (const char *name : {"--time-limit", "--max-error", "--max-time", "--report"}) {
    command->remove_option(command->get_option(name));
  }
  command->footer(exclusions_text(*command));
  command->add_option("-o,--plan", options->plan, "PLAN.json: the parts, and the options that they have in common")
      ->required();
  command->add_option("--pictures", options->pictures,
                      "OUT_####.exr: the pictures; {scene} in the name is replaced by that of the scene (default: the "
                      "scene's name)");
  command->add_option("--target-seconds", options->target_seconds, "Time of a part, s")
      ->capture_default_str()
      ->check(number_range(1e-3, 1e9));
  command
      ->add_option("--seconds-per-frame", options->seconds_per_frame,
                   "Time of a picture, s (default: some samples of the middle frame are drawn)")
      ->check(number_range(1e-9, 1e9));
  command->add_option("--tiles", options->tile_count, "Strips of each picture that are parts of their own")
      ->capture_default_str()
      ->check(CLI::Range(1, 65536));
  command->callback([options, command, &status] { status = plan(*options, *command); });
}

}  // namespace gnomon::cli
