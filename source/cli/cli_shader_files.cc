// SPDX-License-Identifier: MIT
#include "cli_shader_files.hh"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

struct Ending {
  shader_check::Stage stage;
  std::size_t size;
};

struct OtherEnding {
  shader_check::Stage stage;
  std::string_view ending;
};

/** Endings that people use beside StageName::ending. */
constexpr std::array<OtherEnding, 10> other_endings = {{
    {shader_check::Stage::Vertex, "vs"},
    {shader_check::Stage::Vertex, "vsh"},
    {shader_check::Stage::TessControl, "tcs"},
    {shader_check::Stage::TessEvaluation, "tes"},
    {shader_check::Stage::Geometry, "gs"},
    {shader_check::Stage::Geometry, "gsh"},
    {shader_check::Stage::Fragment, "fs"},
    {shader_check::Stage::Fragment, "fsh"},
    {shader_check::Stage::Compute, "cs"},
    {shader_check::Stage::Compute, "csh"},
}};

/** The ways in which a file's name ends in its stage. */
std::vector<std::string> endings_of(const shader_check::StageName &stage)
{
  std::vector<std::string> endings;
  const auto add = [&](std::string_view word) {
    for (const std::string &ending :
         {fmt::format(".{}", word), fmt::format(".{}.glsl", word), fmt::format("_{}.glsl", word)}) {
      endings.push_back(ending);
    }
  };
  add(stage.ending);
  for (const OtherEnding &other : other_endings) {
    if (other.stage == stage.stage) {
      add(other.ending);
    }
  }
  return endings;
}

std::optional<Ending> ending_of(std::string_view path)
{
  for (const shader_check::StageName &stage : shader_check::stage_names()) {
    for (const std::string &ending : endings_of(stage)) {
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

/** Adds the files beside those of \a program whose stages are between its first and its last. */
static void add_stages_between(shader_check::Program &program)
{
  const std::vector<shader_check::Program::File> given = program.files;
  const auto [first, last] = std::ranges::minmax(given, {}, &shader_check::Program::File::stage);
  for (const shader_check::StageName &stage : shader_check::stage_names()) {
    if (stage.stage <= first.stage || stage.stage >= last.stage || std::ranges::any_of(given, [&](const auto &file) {
          return file.stage == stage.stage || !are_linked(file.stage, stage.stage);
        })) {
      continue;
    }
    const std::vector<std::string> endings = endings_of(stage);
    const auto ending =
        std::ranges::find_if(endings, [&](const std::string &end) { return fs::is_regular_file(program.name + end); });
    if (ending != endings.end()) {
      program.files.push_back({stage.stage, program.name + *ending});
    }
  }
}

/** Whether a stage between the two must follow \a before in every pipeline. */
static bool is_gap(shader_check::Stage before, shader_check::Stage after)
{
  using shader_check::Stage;
  return (before == Stage::TessControl && after > Stage::TessEvaluation) ||
         (before == Stage::Task && after > Stage::Mesh);
}

void complete(std::vector<shader_check::Program> &programs)
{
  std::vector<shader_check::Program> whole;
  for (shader_check::Program &program : programs) {
    add_stages_between(program);
    std::ranges::stable_sort(program.files, {}, &shader_check::Program::File::stage);
    whole.push_back({program.name, {}, program.defines});
    for (shader_check::Program::File &file : program.files) {
      std::vector<shader_check::Program::File> &files = whole.back().files;
      if (!files.empty() && is_gap(files.back().stage, file.stage)) {
        whole.push_back({program.name, {}, program.defines});
      }
      whole.back().files.push_back(std::move(file));
    }
  }
  programs = std::move(whole);
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
  for (const OtherEnding &other : other_endings) {
    endings += fmt::format(".{}, ", other.ending);
  }
  return fmt::format(
      "its name ends in none of {}each also as .vert.glsl and _vert.glsl, .surface.glsl, _surface.glsl; "
      "--stage sets the stage",
      endings);
}

bool is_macro_name(std::string_view name)
{
  const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return !name.empty() && is_letter(name.front()) &&
         std::ranges::all_of(name, [&](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
}

std::string shader_define(const std::string &argument)
{
  const std::size_t equals = argument.find('=');
  const std::string name = argument.substr(0, equals);
  const std::size_t parameters = name.find('(');
  if (!is_macro_name(name.substr(0, parameters)) || (parameters != std::string::npos && !name.ends_with(')')) ||
      argument.find_first_of("\r\n") != std::string::npos) {
    return "";
  }
  return name + " " + (equals == std::string::npos ? "1" : argument.substr(equals + 1));
}

void add_define(std::vector<std::string> &defines, const std::string &define)
{
  const auto name_of = [](std::string_view text) { return text.substr(0, text.find_first_of(" (")); };
  std::erase_if(defines, [&](const std::string &earlier) { return name_of(earlier) == name_of(define); });
  defines.push_back(define);
}

void add_defines(std::vector<std::string> &defines, const std::vector<std::string> &arguments)
{
  for (const std::string &argument : arguments) {
    const std::string define = shader_define(argument);
    if (define.empty()) {
      throw UsageError(fmt::format("-D '{}' is not NAME or NAME=VALUE", argument));
    }
    add_define(defines, define);
  }
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
