// SPDX-License-Identifier: MIT
#include "shader_check.hh"

#include "gpu_shader_text.hh"
#include "internal/shader_check_checker.hh"
#include "internal/shader_check_dialect.hh"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace gnomon::shader_check {

namespace {

constexpr std::array<TargetName, 7> targets = {{
    {CheckTarget::OpenGl, "opengl", "OpenGL GLSL"},
    {CheckTarget::OpenGlSpirv, "opengl-spirv", "OpenGL 4.5"},
    {CheckTarget::Es, "es", "OpenGL ES"},
    {CheckTarget::Vulkan10, "vulkan1.0", "Vulkan 1.0"},
    {CheckTarget::Vulkan11, "vulkan1.1", "Vulkan 1.1"},
    {CheckTarget::Vulkan12, "vulkan1.2", "Vulkan 1.2"},
    {CheckTarget::Vulkan13, "vulkan1.3", "Vulkan 1.3"},
}};

constexpr std::array<StageName, 14> stages = {{
    {Stage::Vertex, "vert", "vertex"},
    {Stage::TessControl, "tesc", "tessellation control"},
    {Stage::TessEvaluation, "tese", "tessellation evaluation"},
    {Stage::Geometry, "geom", "geometry"},
    {Stage::Task, "task", "task"},
    {Stage::Mesh, "mesh", "mesh"},
    {Stage::Fragment, "frag", "fragment"},
    {Stage::Compute, "comp", "compute"},
    {Stage::RayGeneration, "rgen", "ray generation"},
    {Stage::Intersection, "rint", "intersection"},
    {Stage::AnyHit, "rahit", "any hit"},
    {Stage::ClosestHit, "rchit", "closest hit"},
    {Stage::Miss, "rmiss", "miss"},
    {Stage::Callable, "rcall", "callable"},
}};

}  // namespace

std::span<const TargetName> check_targets()
{
  return targets;
}

std::string_view to_string(CheckTarget target)
{
  return targets[std::size_t(target)].text;
}

bool is_vulkan(CheckTarget target)
{
  return target >= CheckTarget::Vulkan10;
}

bool has_spirv(CheckTarget target)
{
  return target == CheckTarget::OpenGlSpirv || is_vulkan(target);
}

std::span<const StageName> stage_names()
{
  return stages;
}

std::string_view to_string(Stage stage)
{
  return stages[std::size_t(stage)].text;
}

std::string_view to_string(Severity severity)
{
  return severity == Severity::Error ? "error" : "warning";
}

namespace {

using Reads = CheckRule::Reads;

constexpr std::array<CheckRule, 21> rules = {{
    {"stage", "the name of a file, or an option, gives its stage"},
    {"include", "included files and the files of stages exist"},
    {"compile", "glslang accepts the stage"},
    {"compile-warning", "glslang has no warning about the stage", true},
    {"level-comment", "a comment about a rule names one, and a level", true},
    {"link", "glslang accepts the stages together"},
    {"limit", "the check of a program ends within its limits of time and memory"},
    {"spirv", "SPIRV-Tools accepts glslang's output for the stage", true},
    {"slot", "each block and texture has a slot of its own, the same in each stage", true, true, Reads::Declarations},
    {"missing-varying", "each input of a stage is an output of the previous stage", true, false, Reads::Declarations},
    {"varying-type", "an input has the type of the previous stage's output", true, false, Reads::Declarations},
    {"block-match", "a block has the same members and slot in each stage", true},
    {"layout", "a block has the same layout in C++ and GLSL", true, true, Reads::Declarations},
    {"block-array", "an array in a block has elements that fill rows of 16 bytes", true, true, Reads::Declarations},
    {"block-size", "a uniform block is within the limit that all devices support", true, false, Reads::Declarations},
    {"recursion", "no function calls itself"},
    {"unused-binding", "each declared block or texture is read", true, false, Reads::Declarations},
    {"unread-output", "an output is read by the next stage", true, false, Reads::Declarations},
    {"implicit-conversion", "a member of a block is converted only explicitly", true, false, Reads::Functions},
    {"unbounded-loop", "a value that the loop steps bounds the loop", true, false, Reads::Functions},
    {"unguarded-math", "the argument of a function with a limited domain is guarded", true, false, Reads::Functions},
}};

}  // namespace

std::span<const CheckRule> check_rules()
{
  return rules;
}

std::vector<std::string_view> left_out_rules([[maybe_unused]] CheckTarget target)
{
  std::vector<std::string_view> names;
#if !GNOMON_GLSLANG_TREE
  for (const CheckRule &rule : rules) {
    if (rule.reads == Reads::Functions || (rule.reads == Reads::Declarations && !has_spirv(target))) {
      names.push_back(rule.name);
    }
  }
#endif
  return names;
}

bool ProgramCheck::has_errors() const
{
  return std::ranges::any_of(messages, [](const CheckMessage &m) { return m.severity == Severity::Error; });
}

std::vector<CheckMessage> check_shader(const gpu::ShaderDesc &desc, const gpu::ShaderFiles &files,
                                       const CheckOptions &options)
{
  std::vector<CheckMessage> messages;
  with_large_stack([&] {
    const CheckSettings settings{options, true, {}};
    Checker checker(desc.name, desc.defines, settings);
    try {
      for (gpu::ShaderSource &source : gpu::preprocess(desc, files)) {
        checker.compile(std::make_unique<StageSource>(std::move(source)));
      }
    }
    catch (const gpu::SourceError &error) {
      checker.refuse("include", error.file, error.line, error.text);
    }
    catch (const gpu::Error &error) {
      const std::string &file = !desc.vertex_path.empty()     ? desc.vertex_path
                                : !desc.geometry_path.empty() ? desc.geometry_path
                                                              : desc.fragment_path;
      checker.refuse("include", file, 1, error.what());
    }
    checker.finish();
    messages = checker.messages();
  });
  return messages;
}

/** Files that were read, and paths at which there is none. */
struct TriedFiles {
  std::set<std::string> read;
  std::set<std::string> missed;
};

/** Adds the files that \a compilation has read or not found, and \a tried, to \a result. */
static void add_files(const Compilation &compilation, const TriedFiles &tried, ProgramCheck &result)
{
  const auto add_new = [](std::vector<std::string> &list, const auto &paths) {
    for (const std::string &path : paths) {
      if (std::ranges::find(list, path) == list.end()) {
        list.push_back(path);
      }
    }
  };
  for (const std::unique_ptr<StageSource> &source : compilation.sources) {
    for (const StageSource::File &file : source->texts()) {
      add_new(result.files, std::array{source->files()[file.index]});
    }
    add_new(result.absent, source->absent());
  }
  add_new(result.files, tried.read);
  add_new(result.absent, tried.missed);
}

/**
 * The target of the options, or that which follows from the files, which are sorted by stage. \a second: the first of
 * two files of one stage. \a tried: the choice reads includes under any condition.
 */
static TargetChoice target_of(const std::vector<Program::File> &sorted,
                              std::vector<Program::File>::const_iterator second, const gpu::ShaderFiles &files,
                              const ProgramOptions &options, TriedFiles &tried)
{
  if (options.target) {
    return {*options.target, {}};
  }
  if (second != sorted.end()) {
    return {CheckTarget::OpenGl,
            fmt::format("{} and {} are of one stage, which OpenGL alone links", second->path, std::next(second)->path)};
  }
  const bool has_binary = std::ranges::any_of(sorted, [&](const Program::File &file) {
    return files(file.path).value_or("").find('\0') != std::string_view::npos;
  });
  const bool has_file =
      std::ranges::any_of(sorted, [&](const Program::File &file) { return files(file.path).has_value(); });
  if (has_binary || !has_file) {
    // Without a text, nothing says which target is meant.
    return {CheckTarget::Vulkan12, {}};
  }
  const gpu::ShaderFiles noted = [&](std::string_view path) {
    const std::optional<std::string_view> text = files(path);
    (text ? tried.read : tried.missed).emplace(path);
    return text;
  };
  return choose_target(sorted, noted, options.include_folders);
}

/** \a text with a line feed for each carriage return that none follows. Both end lines. \return empty: it has none */
static std::optional<std::string> with_line_feeds(std::string_view text)
{
  std::optional<std::string> result;
  for (std::size_t at = text.find('\r'); at != std::string_view::npos; at = text.find('\r', at + 1)) {
    if (!text.substr(at + 1).starts_with('\n')) {
      if (!result) {
        result = text;
      }
      (*result)[at] = '\n';
    }
  }
  return result;
}

ProgramCheck check_program(const Program &program, const gpu::ShaderFiles &files, const ProgramOptions &options)
{
  ProgramCheck result;
  std::map<std::string, std::optional<std::string>, std::less<>> with_feeds;
  const gpu::ShaderFiles texts = [&](std::string_view path) {
    const std::optional<std::string_view> text = files(path);
    auto known = with_feeds.find(path);
    if (text && known == with_feeds.end()) {
      known = with_feeds.emplace(path, with_line_feeds(*text)).first;
    }
    return text && known->second ? std::optional<std::string_view>(*known->second) : text;
  };
  with_large_stack([&] {
    std::vector<Program::File> sorted = program.files;
    std::ranges::stable_sort(sorted, {}, &Program::File::stage);
    TriedFiles tried;
    CheckSettings settings{{}, false, options.features};
    settings.options.levels = options.levels;
    settings.options.is_strict = options.is_strict;
    settings.options.stage_errors = options.stage_errors;
    const auto second = std::ranges::adjacent_find(std::as_const(sorted), {}, &Program::File::stage);
    TargetChoice choice = target_of(sorted, second, texts, options, tried);
    result.target = choice.target;
    result.target_reason = std::move(choice.reason);
    settings.options.target = result.target;
    Checker checker(program.name, program.defines, settings);
    for (const Program::File &file : sorted) {
      if (second != sorted.end() && &file == &*std::next(second) && result.target != CheckTarget::OpenGl) {
        checker.refuse("link", file.path, 1,
                       fmt::format("{} has the {} stage as well. Only OpenGL links several shaders of one stage, and "
                                   "the target is {}",
                                   second->path, to_string(file.stage), to_string(result.target)));
      }
      if (const std::optional<std::string_view> text = texts(file.path)) {
        checker.compile(std::make_unique<StageSource>(file.stage, file.path, *text, program.defines, texts,
                                                      options.include_folders));
      }
      else {
        checker.refuse("include", file.path, 1, "there is no such regular file, or it cannot be read");
        tried.missed.insert(file.path);
      }
    }
    checker.finish();
    result.messages = checker.messages();
    if (!result.has_errors()) {
      result.spirv = checker.spirv();
    }
    add_files(checker.compilation(), tried, result);
  });
  return result;
}

}  // namespace gnomon::shader_check
