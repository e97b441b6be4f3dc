// SPDX-License-Identifier: MIT
#include "cli_shader_interfaces.hh"

#include "shader_check_files.hh"

#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

namespace gnomon::cli {

namespace fs = std::filesystem;

void add_interface_options(CLI::App &command, InterfaceArguments &arguments)
{
  add_source_options(command, arguments.include_folders, arguments.defines);
  command.add_option("--target", arguments.target, "Target of files, as for check")
      ->capture_default_str()
      ->check(CLI::IsMember(target_names()));
}

std::vector<NamedInterface> file_interfaces(const InterfaceArguments &arguments)
{
  std::vector<shader_check::Program> programs;
  for (const std::string &file : arguments.files) {
    const std::optional<shader_check::Stage> stage = stage_of(file);
    if (!stage) {
      throw UsageError(fmt::format("{}: {}", file, unknown_stage(file)));
    }
    add_file(programs, *stage, file);
  }
  shader_check::ProgramOptions options;
  options.include_folders = arguments.include_folders;
  if (arguments.target != "auto") {
    options.target = target_of(arguments.target);
  }
  shader_check::FolderFiles folder{fs::path()};
  std::vector<NamedInterface> interfaces;
  for (shader_check::Program &program : programs) {
    add_stages_between(program);
    std::ranges::transform(arguments.defines, std::back_inserter(program.defines), define_of);
    interfaces.push_back(
        {program.name, program.defines, shader_check::program_interface(program, folder.files(), options)});
  }
  return interfaces;
}

std::vector<std::string_view> names_of(const std::vector<shader_check::Stage> &stages)
{
  std::vector<std::string_view> names;
  for (const shader_check::Stage stage : stages) {
    names.push_back(shader_check::to_string(stage));
  }
  return names;
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

}  // namespace gnomon::cli
