// SPDX-License-Identifier: MIT
#include "cli_shaders.hh"

#include "cli_shader_programs.hh"
#include "cli_shader_report.hh"

#include "eevee_programs.hh"
#include "scene_parallel.hh"
#include "scene_types.hh"

#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

struct CheckArguments {
  std::vector<std::string> files;
  std::vector<std::string> include_folders;
  std::vector<std::string> defines;
  std::string stage;
  std::string target = "all";
  std::string format = "text";
  std::string shaders;
  std::string program;
};

std::vector<shader_check::CheckTarget> targets_of(const std::string &name)
{
  if (name == "opengl") {
    return {shader_check::CheckTarget::OpenGl};
  }
  if (name == "vulkan") {
    return {shader_check::CheckTarget::Vulkan};
  }
  return {shader_check::CheckTarget::OpenGl, shader_check::CheckTarget::Vulkan};
}

/** Shows a progress bar on a terminal; silent in a pipe. */
void show_progress(std::size_t done, std::size_t count)
{
  constexpr std::size_t width = 40;
  const std::size_t full = done * width / std::max<std::size_t>(count, 1);
  print_message("\r[{}{}] {}/{}{}", std::string(full, '#'), std::string(width - full, ' '), done, count,
                done == count ? "\r\033[K" : "");
}

/** Checks all of \a descs for all of \a targets, on all cores. */
ShaderReport check_all(const std::vector<gpu::ShaderDesc> &descs, const gpu::ShaderFiles &files,
                       const shader_check::CheckOptions &options, const std::vector<shader_check::CheckTarget> &targets)
{
  const auto start = std::chrono::steady_clock::now();
  const std::size_t job_count = descs.size() * targets.size();
  std::vector<std::vector<shader_check::CheckMessage>> results(job_count);
  std::atomic<std::size_t> done = 0;
  const bool is_terminal = isatty(STDERR_FILENO) != 0;
  const std::thread::id bar_thread = std::this_thread::get_id();
  scene::parallel_for(job_count, 0, [&](std::size_t i) {
    shader_check::CheckOptions job = options;
    job.target = targets[i % targets.size()];
    results[i] = shader_check::check_shader(descs[i / targets.size()], files, job);
    done++;
    if (is_terminal && std::this_thread::get_id() == bar_thread) {
      show_progress(done, job_count);
    }
  });
  if (is_terminal) {
    show_progress(job_count, job_count);
  }
  ShaderReport report;
  for (const std::vector<shader_check::CheckMessage> &messages : results) {
    report.messages.insert(report.messages.end(), messages.begin(), messages.end());
  }
  report.variant_count = descs.size();
  report.targets = targets;
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

/**
 * The programs that draw with a surface function: of each, the variant with the fewest features and the one with the
 * most. Together they have all inputs and outputs that stages share.
 */
std::vector<gpu::ShaderDesc> descs_with_surface_function()
{
  std::vector<gpu::ShaderDesc> descs;
  for (const eevee::ShaderDeclaration &declaration : eevee::shader_declarations()) {
    const std::vector<eevee::Feature> variants = eevee::surface_function_variants(declaration);
    for (std::size_t i = 0; i < variants.size(); i += std::max<std::size_t>(variants.size() - 1, 1)) {
      descs.push_back(with_surface_function(shader_desc(declaration, variants[i]), declaration));
    }
  }
  return descs;
}

ShaderReport check_engine(const CheckArguments &arguments)
{
  const EngineFiles files(arguments.shaders);
  std::vector<gpu::ShaderDesc> descs;
  const std::vector<Variant> variants = engine_variants();
  for (const Variant &variant : variants) {
    if (arguments.program.empty() || variant.desc.name == arguments.program) {
      descs.push_back(variant.desc);
    }
  }
  if (descs.empty()) {
    throw_no_program(arguments.program);
  }
  for (const gpu::ShaderDesc &desc : descs_with_surface_function()) {
    // eevee_depth_function has one in all its variants, which are above.
    const bool is_known = std::ranges::any_of(
        descs, [&](const gpu::ShaderDesc &known) { return known.name == desc.name && known.defines == desc.defines; });
    if (!is_known && (arguments.program.empty() || desc.name == arguments.program)) {
      descs.push_back(desc);
    }
  }
  shader_check::CheckOptions options;
  options.blocks = engine_blocks();
  options.is_block_size_strict = true;
  ShaderReport report = check_all(descs, files.files(), options, targets_of(arguments.target));
  report.program_count = arguments.program.empty() ? program_count(variants) : 1;
  for (shader_check::CheckMessage &message : report.messages) {
    message.file = files.shown(message.file);
  }
  return report;
}

gpu::ShaderStage required_stage(const std::string &file, const std::string &stage_name)
{
  const std::optional<gpu::ShaderStage> stage =
      stage_of(stage_name.empty() ? fs::path(file) : fs::path("." + stage_name));
  if (!stage) {
    throw UsageError(
        fmt::format("{}: its name ends in none of .vert, _vert.glsl, .geom, _geom.glsl, .frag, _frag.glsl, "
                    ".surface.glsl, _surface.glsl; --stage vert|geom|frag|surface sets the stage",
                    file));
  }
  return *stage;
}

std::string &path_of(gpu::ShaderDesc &desc, gpu::ShaderStage stage)
{
  switch (stage) {
    case gpu::ShaderStage::Vertex: return desc.vertex_path;
    case gpu::ShaderStage::Geometry: return desc.geometry_path;
    case gpu::ShaderStage::Fragment: break;
  }
  return desc.fragment_path;
}

/** Converts the `NAME=VALUE` or `NAME` of -D to a define. */
std::string define_of(const std::string &argument)
{
  const std::size_t equals = argument.find('=');
  const std::string name = argument.substr(0, equals);
  if (name.empty()) {
    throw UsageError(fmt::format("-D '{}' is not NAME or NAME=VALUE", argument));
  }
  return name + " " + (equals == std::string::npos ? "1" : argument.substr(equals + 1));
}

/** A surface function in the programs that draw with it. */
ShaderReport check_surface_function(const std::string &file, const CheckArguments &arguments)
{
  shader_check::FolderFiles own{fs::path()};
  const std::optional<std::string_view> text = own.text(file);
  const auto failed = [&](int line, std::string reason) {
    ShaderReport report;
    report.messages.push_back({shader_check::Severity::Error, file, line, std::move(reason), "include", file, "",
                               shader_check::CheckTarget::OpenGl});
    report.targets = targets_of(arguments.target);
    return report;
  };
  if (!text) {
    return failed(1, "there is no such file");
  }
  if (text->size() > scene::SurfaceFunction::text_bytes_max) {
    return failed(1, fmt::format("it has more than {} bytes", scene::SurfaceFunction::text_bytes_max));
  }
  if (const auto fault = eevee::surface_function_fault(*text)) {
    return failed(fault->line, fault->reason);
  }
  const EngineFiles engine("");
  shader_check::CheckOptions options;
  options.blocks = engine_blocks();
  options.is_block_size_strict = true;
  ShaderReport report = check_all(
      descs_with_surface_function(),
      [&](std::string_view path) { return path == eevee::surface_function_file ? text : engine.files()(path); },
      options, targets_of(arguments.target));
  for (shader_check::CheckMessage &message : report.messages) {
    message.file = message.file == eevee::surface_function_file ? file : engine.shown(message.file);
  }
  return report;
}

/** Files whose names differ only in the stage belong to one program. */
ShaderReport check_files(const CheckArguments &arguments)
{
  ShaderReport functions;
  std::size_t function_count = 0;
  std::vector<gpu::ShaderDesc> descs;
  std::vector<std::string> defines;
  std::ranges::transform(arguments.defines, std::back_inserter(defines), define_of);
  for (const std::string &file : arguments.files) {
    if (arguments.stage == "surface" || (arguments.stage.empty() && is_surface_function(file))) {
      const ShaderReport report = check_surface_function(file, arguments);
      std::ranges::copy(report.messages, std::back_inserter(functions.messages));
      functions.variant_count += report.variant_count;
      functions.seconds += report.seconds;
      function_count++;
      continue;
    }
    const gpu::ShaderStage stage = required_stage(file, arguments.stage);
    const std::string name = stem_of(file);
    auto desc = std::ranges::find_if(
        descs, [&](gpu::ShaderDesc &known) { return known.name == name && path_of(known, stage).empty(); });
    if (desc == descs.end()) {
      descs.push_back({name, "", "", "", defines});
      desc = descs.end() - 1;
    }
    path_of(*desc, stage) = file;
  }
  shader_check::FolderFiles files{fs::path()};
  shader_check::CheckOptions options;
  options.include_path = include_path({arguments.include_folders.begin(), arguments.include_folders.end()});
  ShaderReport report = check_all(descs, files.files(), options, targets_of(arguments.target));
  report.program_count = descs.size() + function_count;
  std::ranges::copy(functions.messages, std::back_inserter(report.messages));
  report.variant_count += functions.variant_count;
  report.seconds += functions.seconds;
  return report;
}

Status check(const CheckArguments &arguments)
{
  if (!arguments.files.empty() && !arguments.shaders.empty()) {
    throw UsageError("--shaders and FILES exclude each other");
  }
  if (arguments.files.empty() &&
      !(arguments.include_folders.empty() && arguments.defines.empty() && arguments.stage.empty())) {
    throw UsageError("-I, -D and --stage are for FILES");
  }
  const ShaderReport report = arguments.files.empty() ? check_engine(arguments) : check_files(arguments);
  fmt::print("{}", arguments.format == "json"    ? to_json(report)
                   : arguments.format == "sarif" ? to_sarif(report)
                                                 : to_text(report));
  return report.has_errors() ? Status::Failed : Status::Done;
}

}  // namespace

void add_shaders_check(CLI::App &shaders, Status &status)
{
  CLI::App *command = shaders.add_subcommand("check", "Find mistakes in shaders; needs no driver");
  auto a = std::make_shared<CheckArguments>();
  command->add_option("files", a->files, "Shaders to check (default: all variants of the engine's shaders)");
  command->add_option("-I", a->include_folders, "Folder to search for includes, after that of the including file")
      ->allow_extra_args(false);
  command->add_option("-D", a->defines, "NAME or NAME=VALUE, defined in every stage")->allow_extra_args(false);
  command->add_option("--stage", a->stage, "Stage of FILES (default: from their names)")
      ->check(CLI::IsMember({"vert", "geom", "frag", "surface"}));
  command->add_option("--target", a->target, "opengl, vulkan, all")
      ->capture_default_str()
      ->check(CLI::IsMember({"opengl", "vulkan", "all"}));
  command->add_option("--format", a->format, "text, json, sarif")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json", "sarif"}));
  command->add_option("--shaders", a->shaders, "Folder of the engine's shaders (default: those in the program)");
  command->add_option("--program", a->program, "Check only this program of the engine, by its name in 'shaders list'");
  command->callback([a, &status] { status = check(*a); });
}

}  // namespace gnomon::cli
