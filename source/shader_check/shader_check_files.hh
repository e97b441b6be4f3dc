// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

#include <filesystem>
#include <map>
#include <mutex>

namespace gnomon::shader_check {

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

}  // namespace gnomon::shader_check
