// SPDX-License-Identifier: MIT
#include "cli_shaders.hh"

#include "cli_shader_interfaces.hh"
#include "cli_shader_programs.hh"

#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <iterator>
#include <sstream>

namespace gnomon::cli {

namespace fs = std::filesystem;

namespace {

struct ReflectArguments {
  /** Its `files`: one program of an engine, or files. */
  InterfaceArguments source;
  std::optional<std::string> variant;
  std::string format = "text";
  std::string shaders;
};

/** The variant with these defines, in any order; by default the one with most defines. */
gpu::ShaderDesc find_variant(const ReflectArguments &arguments)
{
  const std::string &program = arguments.source.files.front();
  const auto sorted = [](const std::string &text) {
    std::istringstream stream(text);
    std::vector<std::string> words{std::istream_iterator<std::string>(stream), {}};
    std::ranges::sort(words);
    return words;
  };
  std::vector<Variant> variants = engine_variants();
  std::erase_if(variants, [&](const Variant &variant) { return variant.desc.name != program; });
  if (variants.empty()) {
    throw_no_program(program);
  }
  if (!arguments.variant) {
    return std::ranges::max(variants, {}, [](const Variant &variant) { return variant.desc.defines.size(); }).desc;
  }
  const auto found = std::ranges::find_if(
      variants, [&](const Variant &variant) { return sorted(defines_of(variant.desc)) == sorted(*arguments.variant); });
  if (found == variants.end()) {
    throw std::runtime_error(fmt::format("program '{}' has no variant '{}'; 'gnomon shaders list' lists all variants",
                                         program, *arguments.variant));
  }
  return found->desc;
}

NamedInterface engine_interface(const ReflectArguments &arguments)
{
  const EngineFiles files(arguments.shaders);
  const gpu::ShaderDesc desc = find_variant(arguments);
  return {desc.name, desc.defines, shader_check::program_interface(desc, files.files())};
}

std::vector<std::string_view> names_of(const std::vector<shader_check::Stage> &stages)
{
  std::vector<std::string_view> names;
  for (const shader_check::Stage stage : stages) {
    names.push_back(shader_check::to_string(stage));
  }
  return names;
}

nlohmann::json to_json(const std::vector<shader_check::StageVariable> &variables)
{
  nlohmann::json list = nlohmann::json::array();
  for (const shader_check::StageVariable &variable : variables) {
    list.push_back({{"name", variable.name}, {"type", variable.type}, {"location", variable.location}});
  }
  return list;
}

nlohmann::json to_json(const NamedInterface &program)
{
  nlohmann::json bindings = nlohmann::json::array();
  for (const shader_check::ProgramBinding &binding : program.interface.bindings) {
    nlohmann::json members = nlohmann::json::array();
    for (const shader_check::ProgramBinding::Member &member : binding.members) {
      nlohmann::json arrays = nlohmann::json::array();
      for (const shader_check::ProgramBinding::Array &array : member.arrays) {
        arrays.push_back({{"count", array.count}, {"stride", array.stride_bytes}});
      }
      members.push_back({{"name", member.name},
                         {"type", member.type},
                         {"offset", member.offset_bytes},
                         {"size", member.size_bytes},
                         {"arrays", std::move(arrays)}});
    }
    bindings.push_back({{"kind", to_string(binding.kind)},
                        {"name", binding.name},
                        {"type", binding.type},
                        {"set", binding.set},
                        {"slot", binding.slot},
                        {"size", binding.size_bytes},
                        {"stages", names_of(binding.stages)},
                        {"members", std::move(members)}});
  }
  return {{"program", program.name},
          {"defines", program.defines},
          {"target", to_string(program.interface.target)},
          {"stages", names_of(program.interface.stages)},
          {"bindings", std::move(bindings)},
          {"uniforms", to_json(program.interface.uniforms)},
          {"inputs", to_json(program.interface.inputs)},
          {"outputs", to_json(program.interface.outputs)}};
}

void print_variables(std::string_view kind, const std::vector<shader_check::StageVariable> &variables)
{
  for (const shader_check::StageVariable &variable : variables) {
    fmt::print("{} {} '{}', location {}\n", kind, variable.type, variable.name, variable.location);
  }
}

void print_binding(const shader_check::ProgramBinding &binding)
{
  fmt::print("{} {}'{}'{}, in {}", to_string(binding.kind), binding.type.empty() ? "" : binding.type + " ",
             binding.name, binding.slot < 0 ? "" : fmt::format(", set {}, slot {}", binding.set, binding.slot),
             fmt::join(names_of(binding.stages), ", "));
  fmt::print("{}\n",
             binding.members.empty() ? "" : fmt::format("; {} bytes; offset, size, member:", binding.size_bytes));
  for (const shader_check::ProgramBinding::Member &member : binding.members) {
    fmt::print("  {:>6} {:>6}  {} {}", member.offset_bytes, member.size_bytes, member.type, member.name);
    for (const shader_check::ProgramBinding::Array &array : member.arrays) {
      fmt::print("{}{}", &array == member.arrays.data() ? ", stride " : ", ", array.stride_bytes);
    }
    fmt::print("\n");
  }
}

void print_text(const NamedInterface &program)
{
  fmt::print("{}", program.name);
  for (const std::string &define : program.defines) {
    fmt::print(" {}", define);
  }
  fmt::print(": {} for {}\n", fmt::join(names_of(program.interface.stages), ", "), to_string(program.interface.target));
  print_variables("input", program.interface.inputs);
  print_variables("output", program.interface.outputs);
  print_variables("uniform", program.interface.uniforms);
  std::ranges::for_each(program.interface.bindings, print_binding);
}

/** Programs of engines have no endings and are no files. */
bool is_file(const std::string &program)
{
  return stage_of(program) || fs::exists(program);
}

void reflect(const ReflectArguments &arguments)
{
  const bool is_engine = arguments.source.files.size() == 1 && !is_file(arguments.source.files.front());
  if (is_engine ? !arguments.source.defines.empty() || !arguments.source.include_folders.empty() ||
                      arguments.source.target != "auto"
                : arguments.variant || !arguments.shaders.empty()) {
    throw UsageError(is_engine ? "-I, -D and --target are for files"
                               : "--variant and --shaders are for programs of engines");
  }
  const std::vector<NamedInterface> programs =
      is_engine ? std::vector{engine_interface(arguments)} : file_interfaces(arguments.source);
  if (arguments.format == "json") {
    nlohmann::json document = nlohmann::json::array();
    for (const NamedInterface &program : programs) {
      document.push_back(to_json(program));
    }
    fmt::print("{}\n", (is_engine ? document[0] : document).dump(2));
    return;
  }
  std::ranges::for_each(programs, print_text);
}

}  // namespace

void add_shaders_reflect(CLI::App &shaders, Status &status)
{
  CLI::App *command = shaders.add_subcommand("reflect", "Blocks, textures, inputs and outputs of programs");
  auto a = std::make_shared<ReflectArguments>();
  command
      ->add_option("programs", a->source.files,
                   "Name from 'shaders list', or files, of which those of one stem are a program")
      ->required();
  command->add_option("--variant", a->variant, "Defines of the variant (default: the variant with most)");
  add_interface_options(*command, a->source);
  command->add_option("--format", a->format, "text, json (files: a list)")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json"}));
  command->add_option("--shaders", a->shaders, "Folder of the engine's shaders (default: those in the program)");
  command->callback([a, &status] {
    reflect(*a);
    status = Status::Done;
  });
}

}  // namespace gnomon::cli
