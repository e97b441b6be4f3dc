// SPDX-License-Identifier: MIT
#include "cli.hh"

#include "cli_shader_files.hh"
#include "cli_shader_report.hh"

#include "eevee_blocks.hh"
#include "eevee_shaders.hh"
#include "shader_files.hh"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <unistd.h>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

/** The engine's shaders: those in the program, or a folder's. */
class EngineFiles {
 public:
  explicit EngineFiles(const std::string &folder) : prefix_(folder.empty() ? "shaders" : folder), folder_(folder)
  {
    if (!folder.empty() && !fs::is_directory(folder)) {
      throw std::runtime_error(fmt::format("--shaders {}: no such folder", folder));
    }
    files_ = folder.empty() ? gpu::ShaderFiles(shaders::file) : folder_.files();
  }

  [[nodiscard]] const gpu::ShaderFiles &files() const
  {
    return files_;
  }
  /** A path that an editor can open, from the repository's root where the shaders are the program's. */
  [[nodiscard]] std::string shown(const std::string &path) const
  {
    return (fs::path(prefix_) / path).string();
  }

 private:
  std::string prefix_;
  FolderFiles folder_;
  gpu::ShaderFiles files_;
};

/** One variant of a program. */
struct Variant {
  const eevee::ShaderDeclaration *declaration;
  gpu::ShaderDesc desc;
};

std::vector<Variant> engine_variants()
{
  std::vector<Variant> variants;
  for (const eevee::ShaderDeclaration &declaration : eevee::shader_declarations()) {
    for (const eevee::Feature features : eevee::shader_variants(declaration)) {
      variants.push_back({&declaration, eevee::shader_desc(declaration, features)});
    }
  }
  return variants;
}

[[noreturn]] void throw_no_program(const std::string &name)
{
  throw std::runtime_error(fmt::format("no program '{}'; 'gnomon shaders list' names them", name));
}

std::string defines_of(const gpu::ShaderDesc &desc)
{
  return fmt::format("{}", fmt::join(desc.defines, " "));
}

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

std::vector<gpu::CheckTarget> targets_of(const std::string &name)
{
  if (name == "opengl") {
    return {gpu::CheckTarget::OpenGl};
  }
  if (name == "vulkan") {
    return {gpu::CheckTarget::Vulkan};
  }
  return {gpu::CheckTarget::OpenGl, gpu::CheckTarget::Vulkan};
}

/** A bar on a terminal; nothing in a pipe. */
void show_progress(std::size_t done, std::size_t count)
{
  constexpr std::size_t width = 40;
  const std::size_t full = done * width / std::max<std::size_t>(count, 1);
  fmt::print(stderr, "\r[{}{}] {}/{}{}", std::string(full, '#'), std::string(width - full, ' '), done, count,
             done == count ? "\r\033[K" : "");
}

/** Check all of \a descs for all of \a targets, on all cores. */
ShaderReport check_all(const std::vector<gpu::ShaderDesc> &descs, const gpu::ShaderFiles &files,
                       const gpu::CheckOptions &options, const std::vector<gpu::CheckTarget> &targets)
{
  const auto start = std::chrono::steady_clock::now();
  const std::size_t job_count = descs.size() * targets.size();
  std::vector<std::vector<gpu::CheckMessage>> results(job_count);
  std::atomic<std::size_t> next = 0;
  std::atomic<std::size_t> done = 0;
  const auto work = [&](bool has_bar) {
    for (std::size_t i = next++; i < job_count; i = next++) {
      gpu::CheckOptions job = options;
      job.target = targets[i % targets.size()];
      results[i] = gpu::check_shader(descs[i / targets.size()], files, job);
      done++;
      if (has_bar) {
        show_progress(done, job_count);
      }
    }
  };
  const bool is_terminal = isatty(STDERR_FILENO) != 0;
  std::vector<std::jthread> threads;
  for (std::size_t i = 1; i < std::min<std::size_t>(std::thread::hardware_concurrency(), job_count); i++) {
    threads.emplace_back(work, false);
  }
  work(is_terminal);
  threads.clear();
  if (is_terminal) {
    show_progress(job_count, job_count);
  }
  ShaderReport report;
  for (const std::vector<gpu::CheckMessage> &messages : results) {
    report.messages.insert(report.messages.end(), messages.begin(), messages.end());
  }
  report.variant_count = descs.size();
  report.targets = targets;
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

ShaderReport check_engine(const CheckArguments &arguments)
{
  const EngineFiles files(arguments.shaders);
  std::vector<gpu::ShaderDesc> descs;
  for (Variant &variant : engine_variants()) {
    if (arguments.program.empty() || variant.declaration->name == arguments.program) {
      descs.push_back(std::move(variant.desc));
    }
  }
  if (descs.empty()) {
    throw_no_program(arguments.program);
  }
  gpu::CheckOptions options;
  options.blocks = eevee::block_layouts();
  options.is_block_size_strict = true;
  ShaderReport report = check_all(descs, files.files(), options, targets_of(arguments.target));
  report.program_count = arguments.program.empty() ? eevee::shader_declarations().size() : 1;
  for (gpu::CheckMessage &message : report.messages) {
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
        fmt::format("{}: its name ends in none of .vert, _vert.glsl, .geom, _geom.glsl, .frag, _frag.glsl; "
                    "--stage vert|geom|frag says what it is",
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

/** `NAME=VALUE` and `NAME` as a compiler's -D has them. */
std::string define_of(const std::string &argument)
{
  const std::size_t equals = argument.find('=');
  const std::string name = argument.substr(0, equals);
  if (name.empty()) {
    throw UsageError(fmt::format("-D '{}' is not NAME or NAME=VALUE", argument));
  }
  return name + " " + (equals == std::string::npos ? "1" : argument.substr(equals + 1));
}

/** Files of one name but for the stage are one program. */
ShaderReport check_files(const CheckArguments &arguments)
{
  std::vector<gpu::ShaderDesc> descs;
  std::vector<std::string> defines;
  std::ranges::transform(arguments.defines, std::back_inserter(defines), define_of);
  for (const std::string &file : arguments.files) {
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
  FolderFiles files{fs::path()};
  gpu::CheckOptions options;
  options.include_path = include_path({arguments.include_folders.begin(), arguments.include_folders.end()});
  ShaderReport report = check_all(descs, files.files(), options, targets_of(arguments.target));
  report.program_count = descs.size();
  return report;
}

Status check(const CheckArguments &arguments)
{
  if (!arguments.files.empty() && !arguments.shaders.empty()) {
    throw UsageError("--shaders is for the engine's shaders, FILES for others: not both");
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

void print_list()
{
  std::size_t variant_count = 0;
  for (const eevee::ShaderDeclaration &declaration : eevee::shader_declarations()) {
    fmt::print("{}: {}\n  {}\n  {}\n", declaration.name, declaration.purpose, declaration.vertex_path,
               declaration.fragment_path);
    for (const eevee::Feature features : eevee::shader_variants(declaration)) {
      const std::string defines = defines_of(eevee::shader_desc(declaration, features));
      fmt::print("    {}\n", defines.empty() ? "(no define)" : defines);
      variant_count++;
    }
  }
  for (const eevee::FeatureDefine &define : eevee::feature_defines()) {
    fmt::print("{}: where {}\n", define.define, define.purpose);
  }
  fmt::print("{} programs, {} variants\n", eevee::shader_declarations().size(), variant_count);
}

struct ReflectArguments {
  std::string program;
  std::optional<std::string> variant;
  std::string format = "text";
  std::string shaders;
};

/** The variant with these defines, in any order; without any word, the one with most. */
gpu::ShaderDesc find_variant(const ReflectArguments &arguments)
{
  const auto sorted = [](const std::string &text) {
    std::istringstream stream(text);
    std::vector<std::string> words{std::istream_iterator<std::string>(stream), {}};
    std::ranges::sort(words);
    return words;
  };
  std::vector<Variant> variants = engine_variants();
  std::erase_if(variants, [&](const Variant &variant) { return variant.declaration->name != arguments.program; });
  if (variants.empty()) {
    throw_no_program(arguments.program);
  }
  if (!arguments.variant) {
    return std::ranges::max(variants, {}, [](const Variant &variant) { return variant.desc.defines.size(); }).desc;
  }
  const auto found = std::ranges::find_if(
      variants, [&](const Variant &variant) { return sorted(defines_of(variant.desc)) == sorted(*arguments.variant); });
  if (found == variants.end()) {
    throw std::runtime_error(fmt::format("program '{}' has no variant '{}'; 'gnomon shaders list' names them",
                                         arguments.program, *arguments.variant));
  }
  return found->desc;
}

nlohmann::json to_json(const std::vector<gpu::ShaderInterface::Member> &members)
{
  nlohmann::json list = nlohmann::json::array();
  for (const auto &member : members) {
    list.push_back({{"name", member.name}, {"offset", member.offset_bytes}, {"size", member.size_bytes}});
  }
  return list;
}

nlohmann::json to_json(const std::vector<gpu::StageVariable> &variables)
{
  nlohmann::json list = nlohmann::json::array();
  for (const gpu::StageVariable &variable : variables) {
    list.push_back({{"name", variable.name}, {"type", variable.type}, {"location", variable.location}});
  }
  return list;
}

void print_json(const gpu::ShaderDesc &desc, const gpu::ShaderInterface &interface,
                const gpu::StageVariables &variables)
{
  nlohmann::json bindings = nlohmann::json::array();
  for (const auto &binding : interface.bindings) {
    bindings.push_back({{"name", binding.name},
                        {"kind", to_string(binding.kind)},
                        {"slot", binding.slot},
                        {"size", binding.size_bytes},
                        {"members", to_json(binding.members)}});
  }
  nlohmann::json push_constants;
  if (interface.push_constant_size_bytes > 0) {
    push_constants = {{"slot", interface.push_constant_slot},
                      {"size", interface.push_constant_size_bytes},
                      {"members", to_json(interface.push_constant_members)}};
  }
  const nlohmann::json document = {{"program", desc.name},
                                   {"defines", desc.defines},
                                   {"bindings", bindings},
                                   {"push_constants", push_constants},
                                   {"inputs", to_json(variables.inputs)},
                                   {"outputs", to_json(variables.outputs)}};
  fmt::print("{}\n", document.dump(2));
}

void print_members(const std::vector<gpu::ShaderInterface::Member> &members)
{
  for (const auto &member : members) {
    fmt::print("  {:>6} {:>6}  {}\n", member.offset_bytes, member.size_bytes, member.name);
  }
}

void print_variables(std::string_view kind, const std::vector<gpu::StageVariable> &variables)
{
  for (const gpu::StageVariable &variable : variables) {
    fmt::print("{} {} '{}', location {}\n", kind, variable.type, variable.name, variable.location);
  }
}

void print_text(const gpu::ShaderDesc &desc, const gpu::ShaderInterface &interface,
                const gpu::StageVariables &variables)
{
  const std::string defines = defines_of(desc);
  fmt::print("{}{}{}\n", desc.name, defines.empty() ? "" : " ", defines);
  print_variables("input", variables.inputs);
  print_variables("output", variables.outputs);
  for (const auto &binding : interface.bindings) {
    const bool is_texture = binding.kind == gpu::BindingKind::Texture;
    fmt::print("{} '{}', slot {}{}\n", to_string(binding.kind), binding.name, binding.slot,
               is_texture ? "" : fmt::format(", {} bytes; offset, size, member:", binding.size_bytes));
    print_members(binding.members);
  }
  if (interface.push_constant_size_bytes > 0) {
    fmt::print("push constants, slot {}, {} bytes; offset, size, member:\n", interface.push_constant_slot,
               interface.push_constant_size_bytes);
    print_members(interface.push_constant_members);
  }
}

void reflect(const ReflectArguments &arguments)
{
  const EngineFiles files(arguments.shaders);
  const gpu::ShaderDesc desc = find_variant(arguments);
  const gpu::ShaderInterface interface = gpu::reflect(desc.name, gpu::preprocess(desc, files.files()));
  const gpu::StageVariables variables = gpu::stage_variables(desc, files.files());
  (arguments.format == "json" ? print_json : print_text)(desc, interface, variables);
}

/** Of each block, from the first variant that reads it; check() looks at all. */
std::vector<gpu::BlockComparison> compare_engine_blocks(const gpu::ShaderFiles &files)
{
  std::vector<gpu::BlockComparison> comparisons;
  for (const Variant &variant : engine_variants()) {
    for (gpu::BlockComparison &comparison : gpu::compare_blocks(variant.desc, files, eevee::block_layouts())) {
      if (std::ranges::find(comparisons, comparison.block, &gpu::BlockComparison::block) == comparisons.end()) {
        comparisons.push_back(std::move(comparison));
      }
    }
    if (comparisons.size() == eevee::block_layouts().size()) {
      break;
    }
  }
  return comparisons;
}

Status layout(const std::string &folder)
{
  const EngineFiles files(folder);
  const auto offset = [](std::optional<std::size_t> bytes) {
    return bytes ? std::to_string(*bytes) : std::string("-");
  };
  const std::vector<gpu::BlockComparison> comparisons = compare_engine_blocks(files.files());
  Status status = Status::Done;
  for (const gpu::BlockComparison &comparison : comparisons) {
    fmt::print("{}: {} bytes in C++, {} in GLSL\n     C++   GLSL\n", comparison.block, comparison.cpp_size_bytes,
               comparison.glsl_size_bytes);
    for (const auto &field : comparison.fields) {
      fmt::print("  {:>6} {:>6}  {}{}\n", offset(field.cpp_offset_bytes), offset(field.glsl_offset_bytes), field.name,
                 field.cpp_offset_bytes == field.glsl_offset_bytes ? "" : "  <-- differs");
    }
  }
  for (const gpu::BlockComparison &comparison : comparisons) {
    for (const gpu::BlockDifference &difference : gpu::differences(comparison)) {
      fmt::print("{}:{}: error: {} [layout]\n", files.shown(difference.file), difference.line, difference.text);
      status = Status::Failed;
    }
  }
  for (const gpu::BlockLayout &block : eevee::block_layouts()) {
    if (std::ranges::find(comparisons, block.name, &gpu::BlockComparison::block) == comparisons.end()) {
      fmt::print("error: block '{}' is read by no shader [layout]\n", block.name);
      status = Status::Failed;
    }
  }
  return status;
}

void add_check(CLI::App &shaders, Status &status)
{
  CLI::App *command = shaders.add_subcommand("check", "Look for mistakes, without running anything");
  auto a = std::make_shared<CheckArguments>();
  command->add_option("files", a->files, "A user's own shaders; without any, the engine's, every variant");
  command->add_option("-I", a->include_folders, "Folder to look for includes in, after the including file's own")
      ->allow_extra_args(false);
  command->add_option("-D", a->defines, "NAME or NAME=VALUE, defined in every stage")->allow_extra_args(false);
  command->add_option("--stage", a->stage, "What FILES are; otherwise their names tell")
      ->check(CLI::IsMember({"vert", "geom", "frag"}));
  command->add_option("--target", a->target, "opengl, vulkan, all")
      ->capture_default_str()
      ->check(CLI::IsMember({"opengl", "vulkan", "all"}));
  command->add_option("--format", a->format, "text, json, sarif")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json", "sarif"}));
  command->add_option("--shaders", a->shaders, "Folder to read the engine's shaders from, instead of the program");
  command->add_option("--program", a->program, "Only this one of the engine's, as 'shaders list' names it");
  command->callback([a, &status] { status = check(*a); });
}

void add_reflect(CLI::App &shaders, Status &status)
{
  CLI::App *command = shaders.add_subcommand("reflect", "What a program reads, and where it is");
  auto a = std::make_shared<ReflectArguments>();
  command->add_option("program", a->program, "As 'shaders list' names it")->required();
  command->add_option("--variant", a->variant, "Its defines; otherwise the variant with most");
  command->add_option("--format", a->format, "text, json")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json"}));
  command->add_option("--shaders", a->shaders, "Folder to read the engine's shaders from, instead of the program");
  command->callback([a, &status] {
    reflect(*a);
    status = Status::Done;
  });
}

}  // namespace

void add_shaders(CLI::App &app, Status &status)
{
  CLI::App *command = app.add_subcommand("shaders", "Check, list and reflect shaders");
  command->require_subcommand(1);
  command->add_subcommand("list", "Every program and variant, and why it exists")->callback([&status] {
    print_list();
    status = Status::Done;
  });
  add_check(*command, status);
  add_reflect(*command, status);
  auto folder = std::make_shared<std::string>();
  CLI::App *layout_command = command->add_subcommand("layout", "Blocks as C++ and GLSL have them, side by side");
  layout_command->add_option("--shaders", *folder, "Folder to read the engine's shaders from, instead of the program");
  layout_command->callback([folder, &status] { status = layout(*folder); });
}

}  // namespace gnomon::cli
