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

nlohmann::json to_json(const std::vector<shader_check::StageVariable> &variables, bool has_components)
{
  nlohmann::json list = nlohmann::json::array();
  for (const shader_check::StageVariable &variable : variables) {
    list.push_back({{"name", variable.name}, {"type", variable.type}, {"location", variable.location}});
    if (has_components) {
      list.back()["component"] = variable.component;
      list.back()["index"] = variable.index;
    }
  }
  return list;
}

nlohmann::json to_json(const shader_check::ProgramBinding::Member &member)
{
  nlohmann::json arrays = nlohmann::json::array();
  for (const shader_check::ProgramBinding::Array &array : member.arrays) {
    arrays.push_back({{"count", array.count}, {"stride", array.stride_bytes}});
  }
  nlohmann::json result = {{"name", member.name},
                           {"type", member.type},
                           {"offset", member.offset_bytes},
                           {"size", member.size_bytes},
                           {"arrays", std::move(arrays)}};
  if (member.matrix_stride_bytes > 0) {
    result["matrix_stride"] = member.matrix_stride_bytes;
    result["row_major"] = member.is_row_major;
  }
  return result;
}

nlohmann::json to_json(const shader_check::ProgramBinding &binding)
{
  using Kind = shader_check::ProgramBinding::Kind;
  nlohmann::json members = nlohmann::json::array();
  for (const shader_check::ProgramBinding::Member &member : binding.members) {
    members.push_back(to_json(member));
  }
  nlohmann::json result = {{"kind", to_string(binding.kind)},
                           {"name", binding.name},
                           {"type", binding.type},
                           {"counts", binding.counts},
                           {"set", binding.set},
                           {"slot", binding.slot},
                           {"size", binding.size_bytes},
                           {"stages", names_of(binding.stages)},
                           {"members", std::move(members)}};
  if (binding.kind == Kind::Image) {
    result["format"] = binding.format;
  }
  if (binding.kind == Kind::Image || binding.kind == Kind::StorageBlock) {
    result["qualifiers"] = binding.qualifiers;
  }
  if (binding.kind == Kind::SubpassInput) {
    result["input_attachment_index"] = binding.attachment;
  }
  if (binding.kind == Kind::AtomicCounter) {
    result["offset"] = binding.offset_bytes;
  }
  return result;
}

nlohmann::json to_json(const NamedInterface &program)
{
  nlohmann::json bindings = nlohmann::json::array();
  for (const shader_check::ProgramBinding &binding : program.interface.bindings) {
    bindings.push_back(to_json(binding));
  }
  nlohmann::json constants = nlohmann::json::array();
  for (const shader_check::ProgramConstant &constant : program.interface.constants) {
    constants.push_back({{"id", constant.id}, {"name", constant.name}, {"type", constant.type}});
    std::visit([&](auto value) { constants.back()["value"] = value; }, constant.value);
  }
  nlohmann::json workgroups = nlohmann::json::array();
  for (const shader_check::Workgroup &workgroup : program.interface.workgroups) {
    workgroups.push_back(
        {{"stage", to_string(workgroup.stage)}, {"size", workgroup.size}, {"constant_ids", workgroup.constant_ids}});
  }
  return {{"program", program.name},
          {"defines", program.defines},
          {"target", to_string(program.interface.target)},
          {"stages", names_of(program.interface.stages)},
          {"bindings", std::move(bindings)},
          {"uniforms", to_json(program.interface.uniforms, false)},
          {"inputs", to_json(program.interface.inputs, true)},
          {"outputs", to_json(program.interface.outputs, true)},
          {"constants", std::move(constants)},
          {"workgroups", std::move(workgroups)}};
}

void print_variables(std::string_view kind, const std::vector<shader_check::StageVariable> &variables)
{
  for (const shader_check::StageVariable &variable : variables) {
    fmt::print("{} {} '{}', location {}{}{}\n", kind, variable.type, variable.name, variable.location,
               variable.component == 0 ? "" : fmt::format(", component {}", variable.component),
               variable.index == 0 ? "" : fmt::format(", index {}", variable.index));
  }
}

void print_binding(const shader_check::ProgramBinding &binding)
{
  const bool is_block = binding.type.empty();
  fmt::print("{} {}'{}'", to_string(binding.kind), is_block ? "" : binding.type + " ", binding.name);
  for (const int count : is_block ? binding.counts : std::vector<int>()) {
    fmt::print("[{}]", count == 0 ? "" : std::to_string(count));
  }
  if (binding.slot >= 0) {
    fmt::print(", set {}, slot {}", binding.set, binding.slot);
  }
  if (binding.kind == shader_check::ProgramBinding::Kind::AtomicCounter) {
    fmt::print(", offset {}", binding.offset_bytes);
  }
  if (binding.attachment >= 0) {
    fmt::print(", attachment {}", binding.attachment);
  }
  if (!binding.format.empty()) {
    fmt::print(", {}", binding.format);
  }
  for (const std::string_view qualifier : binding.qualifiers) {
    fmt::print(", {}", qualifier);
  }
  fmt::print(", in {}", fmt::join(names_of(binding.stages), ", "));
  fmt::print("{}\n",
             binding.members.empty() ? "" : fmt::format("; {} bytes; offset, size, member:", binding.size_bytes));
  for (const shader_check::ProgramBinding::Member &member : binding.members) {
    fmt::print("  {:>6} {:>6}  {} {}", member.offset_bytes, member.size_bytes, member.type, member.name);
    for (const shader_check::ProgramBinding::Array &array : member.arrays) {
      fmt::print("{}{}", &array == member.arrays.data() ? ", stride " : ", ", array.stride_bytes);
    }
    fmt::print("{}\n", member.is_row_major ? ", row_major" : "");
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
  for (const shader_check::ProgramConstant &constant : program.interface.constants) {
    fmt::print("constant {} '{}', id {}, {}\n", constant.type, constant.name, constant.id,
               std::visit([](auto value) { return fmt::format("{}", value); }, constant.value));
  }
  for (const shader_check::Workgroup &workgroup : program.interface.workgroups) {
    fmt::print("workgroup of the {} stage:", to_string(workgroup.stage));
    for (std::size_t i = 0; i < workgroup.size.size(); i++) {
      const int id = workgroup.constant_ids[i];
      fmt::print(" {}{}", workgroup.size[i], id < 0 ? "" : fmt::format(" (constant {})", id));
    }
    fmt::print("\n");
  }
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
