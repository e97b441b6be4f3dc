// SPDX-License-Identifier: MIT
#include "cli_shader_interfaces.hh"

#include "shader_check_files.hh"

#include <fmt/format.h>

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
  complete(programs);
  for (shader_check::Program &program : programs) {
    add_defines(program.defines, arguments.defines);
    interfaces.push_back(
        {program.name, program.defines, shader_check::program_interface(program, folder.files(), options)});
  }
  return interfaces;
}

}  // namespace gnomon::cli
