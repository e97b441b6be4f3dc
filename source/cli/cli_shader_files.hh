// SPDX-License-Identifier: MIT
#pragma once

#include "shader_check.hh"

#include <filesystem>

namespace gnomon::cli {

/** The stage by the file's name: `x.vert`, `x.vert.glsl` or `x_vert.glsl`; the same for all stages. */
[[nodiscard]] std::optional<shader_check::Stage> stage_of(const std::filesystem::path &path);

/** Whether the name is that of a surface function: `x.surface.glsl` or `x_surface.glsl`. */
[[nodiscard]] bool is_surface_function(const std::filesystem::path &path);

/** \a path with the ending of \a stage in the place of its own, in the same spelling; empty if it has none. */
[[nodiscard]] std::string with_stage(const std::filesystem::path &path, shader_check::Stage stage);

/** The path without the part that stage_of() reads. All stages of a program have the same stem. */
[[nodiscard]] std::string stem_of(const std::filesystem::path &path);

}  // namespace gnomon::cli
