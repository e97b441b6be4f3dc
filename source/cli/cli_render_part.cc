// SPDX-License-Identifier: MIT
#include "cli_render_part.hh"

#include "cli_frames.hh"
#include "cli_origin.hh"
#include "cli_render.hh"
#include "cli_render_report.hh"
#include "cli_system.hh"
#include "cli_time.hh"
#include "cli_work_plan.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <numeric>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

/** The options that go with --part: those of the process. */
constexpr std::array<std::string_view, 6> options_of_part_process = {"--help",  "--part",       "--json",
                                                                     "--trace", "--stop-after", "--progress"};

/** The options of the plan's part. \a given: those of the command line. \throws CLI::ParseError */
RenderOptions options_of_part(const RenderOptions &given, const WorkPlan &plan, const WorkPart &part)
{
  const PlannedScene &scene = plan.scenes[part.scene];
  std::vector<std::string> arguments = plan.arguments;
  if (!part.frames.empty()) {
    arguments.insert(arguments.end(), {"--step", fmt::format("{}", plan.frame_step)});
  }
  for (const auto &[name, value] : {std::pair("--frames", part.frames),
                                    {"--tile", part.tile},
                                    {"--sample-range", part.samples},
                                    {"--output", part.output}}) {
    if (!value.empty()) {
      arguments.insert(arguments.end(), {name, value});
    }
  }
  // After the options, because a name may begin with a dash.
  arguments.insert(arguments.end(), {"--", scene.path});
  CLI::App app;
  RenderOptions options;
  add_render_options(app, options);
  std::ranges::reverse(arguments);
  app.parse(std::move(arguments));
  options.frames.is_resumed = true;
  options.plan_id = plan.id();
  options.planned_scene = scene.fingerprint;
  options.part = given.part;
  options.plan = fs::absolute(PartName(given.part).plan);
  options.stop_seconds = given.stop_seconds;
  options.has_progress_lines = given.has_progress_lines;
  const auto absolute = [](const std::string &path) { return path.empty() ? path : fs::absolute(path).string(); };
  options.json = absolute(given.json);
  options.trace = absolute(given.trace);
  return options;
}

bool has_all_pictures(const RenderOptions &options)
{
  const FrameSequence frames(options.frames, options.output);
  for (int i = 0; i < frames.count(); i++) {
    if (!frames.is_done(i, options.size_px(), options.plan_id)) {
      return false;
    }
  }
  return true;
}

}  // namespace

Status render_part(const RenderOptions &given, const CLI::App &command)
{
  const Clock::time_point start = Clock::now();
  for (const CLI::Option *option : command.get_options()) {
    if (option->count() > 0 &&
        std::ranges::find(options_of_part_process, option->get_name()) == options_of_part_process.end()) {
      throw UsageError(
          fmt::format("{} does not go with --part, whose options are those of the plan", option->get_name()));
    }
  }
  const PartName name(given.part);
  const WorkPlan plan = read_plan(name.plan, program_name());
  if (name.index >= plan.parts.size()) {
    throw UsageError(fmt::format("--part '{}': the plan has the parts 0 to {}", given.part, plan.parts.size() - 1));
  }
  const RenderOptions options = options_of_part(given, plan, plan.parts[name.index]);
  fs::current_path(fs::absolute(name.plan).parent_path() / plan.folder);
  RenderResult result;
  const auto print_line = [&](const char *part_status) {
    const double picture_seconds = std::reduce(result.frame_seconds.begin(), result.frame_seconds.end());
    const nlohmann::json line = {{"part", name.index},
                                 {"status", part_status},
                                 {"host", host_name()},
                                 {"seconds", seconds_since(start)},
                                 {"memory_bytes", memory_bytes_max()},
                                 {"picture_seconds", picture_seconds},
                                 {"output_seconds", result.output_seconds},
                                 {"pictures", result.frame_seconds.size()},
                                 {"samples", result.samples_drawn}};
    fmt::print("{}\n", line.dump());
  };
  const WorkPart &part = plan.parts[name.index];
  const bool is_joined = part.is_of_picture() && planned_fault(picture_of(plan, part), options.plan_id).empty();
  if (is_joined || has_all_pictures(options)) {
    print_line("skipped");
    return Status::Done;
  }
  try {
    const Status status = render(options, result);
    print_line(status == Status::Done ? "done" : status == Status::Stopped ? "stopped" : "failed");
    return status;
  }
  catch (...) {
    print_line("failed");
    throw;
  }
}

}  // namespace gnomon::cli
