// SPDX-License-Identifier: MIT
#include "cli_shaders.hh"

#include "cli_shader_programs.hh"

#include "shader_check_reflection.hh"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <iterator>
#include <sstream>

namespace gnomon::cli {

namespace {

struct ReflectArguments {
  std::string program;
  std::optional<std::string> variant;
  std::string format = "text";
  std::string shaders;
};

/** The variant with these defines, in any order; by default the one with most defines. */
gpu::ShaderDesc find_variant(const ReflectArguments &arguments)
{
  const auto sorted = [](const std::string &text) {
    std::istringstream stream(text);
    std::vector<std::string> words{std::istream_iterator<std::string>(stream), {}};
    std::ranges::sort(words);
    return words;
  };
  std::vector<Variant> variants = engine_variants();
  std::erase_if(variants, [&](const Variant &variant) { return variant.desc.name != arguments.program; });
  if (variants.empty()) {
    throw_no_program(arguments.program);
  }
  if (!arguments.variant) {
    return std::ranges::max(variants, {}, [](const Variant &variant) { return variant.desc.defines.size(); }).desc;
  }
  const auto found = std::ranges::find_if(
      variants, [&](const Variant &variant) { return sorted(defines_of(variant.desc)) == sorted(*arguments.variant); });
  if (found == variants.end()) {
    throw std::runtime_error(fmt::format("program '{}' has no variant '{}'; 'gnomon shaders list' lists all variants",
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

nlohmann::json to_json(const std::vector<shader_check::StageVariable> &variables)
{
  nlohmann::json list = nlohmann::json::array();
  for (const shader_check::StageVariable &variable : variables) {
    list.push_back({{"name", variable.name}, {"type", variable.type}, {"location", variable.location}});
  }
  return list;
}

void print_json(const gpu::ShaderDesc &desc, const gpu::ShaderInterface &interface,
                const shader_check::StageVariables &variables)
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

void print_variables(std::string_view kind, const std::vector<shader_check::StageVariable> &variables)
{
  for (const shader_check::StageVariable &variable : variables) {
    fmt::print("{} {} '{}', location {}\n", kind, variable.type, variable.name, variable.location);
  }
}

void print_text(const gpu::ShaderDesc &desc, const gpu::ShaderInterface &interface,
                const shader_check::StageVariables &variables)
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
  const gpu::ShaderInterface interface = shader_check::reflect(desc.name, gpu::preprocess(desc, files.files()));
  const shader_check::StageVariables variables = shader_check::stage_variables(desc, files.files());
  (arguments.format == "json" ? print_json : print_text)(desc, interface, variables);
}

}  // namespace

void add_shaders_reflect(CLI::App &shaders, Status &status)
{
  CLI::App *command = shaders.add_subcommand("reflect", "Blocks, textures, inputs and outputs of a program");
  auto a = std::make_shared<ReflectArguments>();
  command->add_option("program", a->program, "Name from 'shaders list'")->required();
  command->add_option("--variant", a->variant, "Defines of the variant (default: the variant with most)");
  command->add_option("--format", a->format, "text, json")
      ->capture_default_str()
      ->check(CLI::IsMember({"text", "json"}));
  command->add_option("--shaders", a->shaders, "Folder of the engine's shaders (default: those in the program)");
  command->callback([a, &status] {
    reflect(*a);
    status = Status::Done;
  });
}

}  // namespace gnomon::cli
