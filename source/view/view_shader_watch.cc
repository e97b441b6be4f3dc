// SPDX-License-Identifier: MIT
#include "view_shader_watch.hh"

#include "shader_check_files.hh"

#include <fmt/format.h>

#include <memory>
#include <stdexcept>
#include <system_error>

namespace gnomon::view {

namespace fs = std::filesystem;

ShaderWatch::ShaderWatch(fs::path folder) : folder_(std::move(folder))
{
  if (!fs::is_directory(folder_)) {
    throw std::runtime_error(fmt::format("{}: no such folder", folder_.string()));
  }
}

bool ShaderWatch::has_changed()
{
  std::map<std::string, fs::file_time_type> times;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder_, error), end; !error && at != end; at.increment(error)) {
    // Skip a file that was removed during the scan.
    std::error_code file_error;
    const fs::file_time_type time = fs::last_write_time(at->path(), file_error);
    if (!file_error) {
      times.emplace(at->path().string(), time);
    }
  }
  const bool is_changed = !has_looked_ || times != times_;
  has_looked_ = true;
  times_ = std::move(times);
  return is_changed;
}

gpu::ShaderFiles ShaderWatch::files() const
{
  return [files = std::make_shared<shader_check::FolderFiles>(folder_)](std::string_view path) {
    return files->text(path);
  };
}

}  // namespace gnomon::view
