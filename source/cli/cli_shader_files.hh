// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

#include <filesystem>

namespace gnomon::cli {

/** Searches an include in the folder of the including file, and then in \a folders in order. */
[[nodiscard]] gpu::IncludePath include_path(std::vector<std::filesystem::path> folders);

/** The stage by the file's name: `x.vert`, `x.vert.glsl` or `x_vert.glsl`; also with `geom` and `frag`. */
[[nodiscard]] std::optional<gpu::ShaderStage> stage_of(const std::filesystem::path &path);

/** Whether the name is that of a surface function: `x.surface.glsl` or `x_surface.glsl`. */
[[nodiscard]] bool is_surface_function(const std::filesystem::path &path);

/** The path without the part that stage_of() reads. All stages of a program have the same stem. */
[[nodiscard]] std::string stem_of(const std::filesystem::path &path);

}  // namespace gnomon::cli
