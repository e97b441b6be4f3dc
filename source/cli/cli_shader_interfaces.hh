// SPDX-License-Identifier: MIT
// The interfaces of a user's shaders, for `gnomon shaders reflect` and `layout`.
#pragma once

#include "cli_shader_files.hh"

#include "shader_check_program.hh"

namespace gnomon::cli {

struct InterfaceArguments {
  std::vector<std::string> files;
  std::vector<std::string> include_folders;
  std::vector<std::string> defines;
  /** One of target_names(). */
  std::string target = "auto";
};

/** Adds -I, -D and --target. */
void add_interface_options(CLI::App &command, InterfaceArguments &arguments);

/** A program with the text that tells it from others. */
struct NamedInterface {
  std::string name;
  std::vector<std::string> defines;
  shader_check::ProgramInterface interface;
};

/** The programs of the files: those of one stem are one. \throws UsageError, gpu::Error if one does not compile */
[[nodiscard]] std::vector<NamedInterface> file_interfaces(const InterfaceArguments &arguments);

}  // namespace gnomon::cli
