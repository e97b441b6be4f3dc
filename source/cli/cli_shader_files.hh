// SPDX-License-Identifier: MIT
#pragma once

#include "cli.hh"

#include "shader_check.hh"

#include <filesystem>

namespace gnomon::cli {

/** The stage by the file's name: `x.vert`, `x.vert.glsl` or `x_vert.glsl`; the same for all stages. */
[[nodiscard]] std::optional<shader_check::Stage> stage_of(const std::filesystem::path &path);

/** Whether the name is that of a surface function: `x.surface.glsl` or `x_surface.glsl`. */
[[nodiscard]] bool is_surface_function(const std::filesystem::path &path);

/** The path without the part that stage_of() reads. All stages of a program have the same stem. */
[[nodiscard]] std::string stem_of(const std::filesystem::path &path);

/** Adds \a file to the program of its name in \a programs, or to a new one. */
void add_file(std::vector<shader_check::Program> &programs, shader_check::Stage stage, const std::string &file);

/**
 * Adds to each program the files beside its own with stages between its first and its last, because the interfaces of
 * the given files do not meet without them. Where a stage that every pipeline needs is missing, the program becomes
 * two.
 */
void complete(std::vector<shader_check::Program> &programs);

/** Why \a file has no stage: endings that stage_of() knows. */
[[nodiscard]] std::string unknown_stage(const std::string &file);

[[nodiscard]] bool is_macro_name(std::string_view name);

/** Converts `NAME=VALUE` or `NAME` to a define; empty if NAME is no name of a macro. */
[[nodiscard]] std::string shader_define(const std::string &argument);

/** Adds a result of shader_define(). It replaces an earlier define of the same name, as compilers do with -D. */
void add_define(std::vector<std::string> &defines, const std::string &define);

/** The same for the values of -D. \throws UsageError */
void add_defines(std::vector<std::string> &defines, const std::vector<std::string> &arguments);

/** Adds -I and -D. */
void add_source_options(CLI::App &command, std::vector<std::string> &include_folders,
                        std::vector<std::string> &defines);

/** Names for --target: auto, vulkan and those of all targets. */
[[nodiscard]] std::vector<std::string> target_names();
/** The target of one of target_names() other than auto. The name vulkan stands for Vulkan 1.2. */
[[nodiscard]] shader_check::CheckTarget target_of(const std::string &name);

}  // namespace gnomon::cli
