// SPDX-License-Identifier: MIT
#include "cli_shader_files.hh"

#include <fmt/format.h>

#include <algorithm>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

struct Ending {
  shader_check::Stage stage;
  std::size_t size;
};

std::optional<Ending> ending_of(std::string_view path)
{
  for (const shader_check::StageName &stage : shader_check::stage_names()) {
    for (const std::string &ending : {fmt::format(".{}", stage.ending), fmt::format(".{}.glsl", stage.ending),
                                      fmt::format("_{}.glsl", stage.ending)}) {
      if (path.ends_with(ending)) {
        return Ending{stage.stage, ending.size()};
      }
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<shader_check::Stage> stage_of(const fs::path &path)
{
  const std::optional<Ending> ending = ending_of(path.string());
  return ending ? std::optional(ending->stage) : std::nullopt;
}

std::string with_stage(const fs::path &path, shader_check::Stage stage)
{
  std::string text = path.string();
  const std::optional<Ending> ending = ending_of(text);
  if (!ending) {
    return {};
  }
  // A dot or an underscore precedes the name of the stage.
  const std::string_view name = shader_check::stage_names()[std::size_t(ending->stage)].ending;
  const std::string_view wanted = shader_check::stage_names()[std::size_t(stage)].ending;
  return text.replace(text.size() - ending->size + 1, name.size(), wanted);
}

bool is_surface_function(const fs::path &path)
{
  const std::string text = path.string();
  return text.ends_with(".surface.glsl") || text.ends_with("_surface.glsl");
}

std::string stem_of(const fs::path &path)
{
  const std::string text = path.string();
  const std::optional<Ending> ending = ending_of(text);
  return ending ? text.substr(0, text.size() - ending->size) : text;
}

/** Whether both are stages of one pipeline of the same kind. */
static bool are_linked(shader_check::Stage a, shader_check::Stage b)
{
  using shader_check::Stage;
  const auto is_mesh = [](Stage stage) { return stage == Stage::Task || stage == Stage::Mesh; };
  const auto is_vertex = [](Stage stage) { return stage < Stage::Task; };
  return a <= Stage::Fragment && b <= Stage::Fragment && !(is_mesh(a) && is_vertex(b)) && !(is_vertex(a) && is_mesh(b));
}

void add_file(std::vector<shader_check::Program> &programs, shader_check::Stage stage, const std::string &file)
{
  const std::string name = stem_of(file);
  const auto takes = [&](const shader_check::Program &program) {
    return program.name == name && std::ranges::all_of(program.files, [&](const auto &other) {
             return other.stage != stage && are_linked(other.stage, stage);
           });
  };
  auto found = std::ranges::find_if(programs, takes);
  if (found == programs.end()) {
    programs.push_back({name, {}, {}});
    found = programs.end() - 1;
  }
  found->files.push_back({stage, file});
}

void add_stages_between(shader_check::Program &program)
{
  using shader_check::Stage;
  const auto path_of = [&](Stage stage) {
    const auto file = std::ranges::find(program.files, stage, &shader_check::Program::File::stage);
    return file == program.files.end() ? std::string() : file->path;
  };
  const std::string vertex = path_of(Stage::Vertex);
  if (vertex.empty() || path_of(Stage::Fragment).empty()) {
    return;
  }
  for (const Stage stage : {Stage::TessControl, Stage::TessEvaluation, Stage::Geometry}) {
    const std::string path = path_of(stage).empty() ? with_stage(vertex, stage) : std::string();
    if (!path.empty() && fs::is_regular_file(path)) {
      program.files.push_back({stage, path});
    }
  }
}

std::string unknown_stage(const std::string &file)
{
  if (file.ends_with(".hlsl")) {
    return "HLSL is not checked";
  }
  std::string endings;
  for (const shader_check::StageName &stage : shader_check::stage_names()) {
    endings += fmt::format(".{}, ", stage.ending);
  }
  return fmt::format(
      "its name ends in none of {}each also as .vert.glsl and _vert.glsl, .surface.glsl, _surface.glsl; "
      "--stage sets the stage",
      endings);
}

std::string shader_define(const std::string &argument)
{
  const std::size_t equals = argument.find('=');
  const std::string name = argument.substr(0, equals);
  return name.empty() ? "" : name + " " + (equals == std::string::npos ? "1" : argument.substr(equals + 1));
}

std::string define_of(const std::string &argument)
{
  std::string define = shader_define(argument);
  if (define.empty()) {
    throw UsageError(fmt::format("-D '{}' is not NAME or NAME=VALUE", argument));
  }
  return define;
}

void add_source_options(CLI::App &command, std::vector<std::string> &include_folders, std::vector<std::string> &defines)
{
  command.add_option("-I", include_folders, "Folder to search for includes, after that of the including file")
      ->allow_extra_args(false);
  command.add_option("-D", defines, "NAME or NAME=VALUE, defined in every stage")->allow_extra_args(false);
}

std::vector<std::string> target_names()
{
  std::vector<std::string> names{"auto", "vulkan"};
  for (const shader_check::TargetName &target : shader_check::check_targets()) {
    names.emplace_back(target.name);
  }
  return names;
}

shader_check::CheckTarget target_of(const std::string &name)
{
  const auto found = std::ranges::find(shader_check::check_targets(), name, &shader_check::TargetName::name);
  return found == shader_check::check_targets().end() ? shader_check::CheckTarget::Vulkan12 : found->target;
}

}  // namespace gnomon::cli
