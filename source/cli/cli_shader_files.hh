// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

#include <filesystem>
#include <map>
#include <mutex>

namespace gnomon::cli {

/** Shader files of a folder, each read once. For several threads. */
class FolderFiles {
 public:
  /** Paths are below \a folder; empty: as they stand. */
  explicit FolderFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /** Valid as long as this. */
  [[nodiscard]] std::optional<std::string_view> text(std::string_view path);
  /** Refers to this. */
  [[nodiscard]] gpu::ShaderFiles files()
  {
    return [this](std::string_view path) { return text(path); };
  }

 private:
  std::filesystem::path folder_;
  std::mutex mutex_;
  std::map<std::string, std::optional<std::string>, std::less<>> texts_;
};

/** An include is looked for beside the file that names it, then in \a folders in order, and nowhere else. */
[[nodiscard]] gpu::IncludePath include_path(std::vector<std::filesystem::path> folders);

/** By the file's name: `x.vert`, `x.vert.glsl`, `x_vert.glsl`, and so for `geom` and `frag`. */
[[nodiscard]] std::optional<gpu::ShaderStage> stage_of(const std::filesystem::path &path);

/** The path without what stage_of() reads: what the stages of one program have in common. */
[[nodiscard]] std::string stem_of(const std::filesystem::path &path);

}  // namespace gnomon::cli
