// SPDX-License-Identifier: MIT
#include "cli_render.hh"

#include "cli_aov.hh"
#include "cli_device.hh"
#include "cli_output.hh"
#include "cli_render_part.hh"
#include "cli_render_scene.hh"
#include "cli_stop.hh"
#include "cli_time.hh"
#include "cli_trace.hh"

#include "gltf_import.hh"

#include <fmt/format.h>

#include <future>
#include <memory>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

/** Adds the outputs, and the inputs that are known before the scene is read. */
void add_files(const RenderOptions &options, const FrameSequence &frames, output::Roles &roles)
{
  roles.add_input(options.scene, "the scene");
  if (!options.part.empty()) {
    roles.add_input(options.plan, "--part");
  }
  if (!options.choice.report_folder.empty()) {
    roles.add_input(fs::path(options.choice.report_folder) / "report.json", "--report");
  }
  roles.add_output(options.json, "--json");
  for (int i = 0; options.has_picture() && i < frames.count(); i++) {
    roles.add_output(frames.path(i), "-o");
  }
}

/** The options of each scene. \throws UsageError where the names of their outputs would be the same */
std::vector<RenderOptions> options_of_scenes(const RenderOptions &options)
{
  if (options.scenes.size() > 1) {
    for (const auto &[option, path] : {std::pair("-o", &options.output), {"--json", &options.json}}) {
      if (!path->empty() && path->find("{scene}") == path->npos) {
        throw UsageError(fmt::format("{} '{}' has no {{scene}} for the names of the scenes", option, *path));
      }
    }
  }
  std::vector<RenderOptions> all;
  for (const std::string &scene : options.scenes) {
    RenderOptions &one = all.emplace_back(options);
    one.scene = scene;
    // Names of a plan are complete: a scene's name may contain the placeholder.
    one.output = options.plan_id.empty() ? scene_name(options.output, scene) : options.output;
    one.json = scene_name(options.json, scene);
  }
  return all;
}

/** Whether the failure is of the device or of an output, so that other scenes would fail as well. */
bool is_of_process(const std::exception &error)
{
  return dynamic_cast<const gpu::TransientError *>(&error) || dynamic_cast<const output::Error *>(&error) ||
         dynamic_cast<const std::bad_alloc *>(&error) || dynamic_cast<const UsageError *>(&error);
}

/** Makes the device while a scene is imported. \throws the scene's error if both fail */
std::unique_ptr<gpu::Device> create_device_during(std::future<ImportedScene> &import, std::string_view backend)
{
  try {
    return create_device(backend);
  }
  catch (...) {
    static_cast<void>(import.get());
    throw;
  }
}

/** Renders all scenes of the options on one device; the next is imported while one is drawn. */
Status render_scenes(const RenderOptions &options, RenderResult &result)
{
  const Clock::time_point start = Clock::now();
  const StopRequests stops(options.stop_seconds);
  const std::vector<RenderOptions> scenes = options_of_scenes(options);
  output::Roles roles;
  roles.add_output(options.trace, "--trace");
  for (const RenderOptions &one : scenes) {
    add_files(one, FrameSequence(one.frames, one.output), roles);
    static_cast<void>(Aov(one.aov));
  }
  // A later scene is read after the pictures of an earlier one are written.
  for (std::size_t i = 1; i < scenes.size(); i++) {
    for (const std::string &file : gltf::files_named_by(scenes[i].scene)) {
      roles.add_input(file, "a file of " + scenes[i].scene);
    }
  }
  keep_text_from(roles);
  std::future<ImportedScene> import = start_import(scenes.front(), stops);
  const std::unique_ptr<gpu::Device> device = create_device_during(import, options.backend);
  result.device = device->description();
  result.device_seconds = seconds_since(start);
  const RenderResult of_device = result;
  Status status = Status::Done;
  Clock::time_point scene_start = start;
  for (std::size_t i = 0; i < scenes.size() && (status == Status::Done || !stops.is_stopped()); i++) {
    std::future<ImportedScene> next;
    try {
      ImportedScene imported = import.get();
      if (!options.plan_id.empty() && imported.fingerprint != options.planned_scene) {
        throw std::runtime_error(
            fmt::format("{}: has changed since the plan was made, or the file of --world has; make the plan again",
                        scenes[i].scene));
      }
      if (i + 1 < scenes.size()) {
        next = start_import(scenes[i + 1], stops);
      }
      result = of_device;
      result.import_seconds = imported.seconds;
      const Status scene_status = render_scene(scenes[i], *device, imported, roles, stops, scene_start, result);
      status = status == Status::Done ? scene_status : status;
    }
    catch (const gltf::ImportCancelled &) {
      status = Status::Stopped;
    }
    catch (const std::exception &error) {
      if (scenes.size() == 1 || is_of_process(error)) {
        throw;
      }
      print_message("gnomon: {}\n", error.what());
      status = Status::Failed;
      if (!next.valid() && i + 1 < scenes.size()) {
        next = start_import(scenes[i + 1], stops);
      }
    }
    import = std::move(next);
    scene_start = Clock::now();
  }
  if (status == Status::Stopped) {
    print_message("gnomon: stopped by {}\n", stops.reason());
  }
  return status;
}

}  // namespace

Status render(RenderOptions options, RenderResult &result)
{
  const TraceFile trace_file(options.trace);
  if (options.scenes.empty()) {
    throw UsageError("render: a scene is required");
  }
  options.check();
  options.debug_view = parse_debug(options.debug);
  const Status status = render_scenes(options, result);
  trace_file.write();
  return status;
}

void add_render(CLI::App &app, Status &status)
{
  auto options = std::make_shared<RenderOptions>();
  CLI::App *command = app.add_subcommand("render", "Light a scene and write the picture");
  add_render_options(*command, *options);
  command->callback([options, command, &status] {
    RenderResult result;
    status = options->part.empty() ? render(*options, result) : render_part(*options, *command);
  });
}

}  // namespace gnomon::cli
