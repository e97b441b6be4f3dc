// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_shader.hh"

#include <filesystem>
#include <map>
#include <string>

namespace gnomon::view {

/** A folder with shader files that are edited while the window is open. */
class ShaderWatch {
 public:
  /** \throws std::runtime_error if the folder does not exist */
  explicit ShaderWatch(std::filesystem::path folder);

  /** Whether a file has been written, added or removed since the last call; true at the first call. */
  [[nodiscard]] bool has_changed();
  [[nodiscard]] const std::filesystem::path &folder() const
  {
    return folder_;
  }
  /** The files as they are now, each read at its first use. Independent of this object. */
  [[nodiscard]] gpu::ShaderFiles files() const;

 private:
  std::filesystem::path folder_;
  bool has_looked_ = false;
  /** The time of the last write of each file. */
  std::map<std::string, std::filesystem::file_time_type> times_;
};

}  // namespace gnomon::view
