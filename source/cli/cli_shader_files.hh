// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

#include <filesystem>
#include <map>
#include <mutex>

namespace gnomon::cli {

/** Shader files of a folder, each read once. Several threads may use it. */
class FolderFiles {
 public:
  /** Paths are relative to \a folder; if it is empty, they are used unchanged. */
  explicit FolderFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /** Valid as long as this object. */
  [[nodiscard]] std::optional<std::string_view> text(std::string_view path);
  /** Refers to this object. */
  [[nodiscard]] gpu::ShaderFiles files()
  {
    return [this](std::string_view path) { return text(path); };
  }

 private:
  std::filesystem::path folder_;
  std::mutex mutex_;
  std::map<std::string, std::optional<std::string>, std::less<>> texts_;
};

/** Searches an include in the folder of the including file, and then in \a folders in order. */
[[nodiscard]] gpu::IncludePath include_path(std::vector<std::filesystem::path> folders);

/** The stage by the file's name: `x.vert`, `x.vert.glsl` or `x_vert.glsl`; also with `geom` and `frag`. */
[[nodiscard]] std::optional<gpu::ShaderStage> stage_of(const std::filesystem::path &path);

/** The path without the part that stage_of() reads. All stages of a program have the same stem. */
[[nodiscard]] std::string stem_of(const std::filesystem::path &path);

}  // namespace gnomon::cli
