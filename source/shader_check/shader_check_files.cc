// SPDX-License-Identifier: MIT
#include "shader_check_files.hh"

#include <fstream>
#include <sstream>

namespace gnomon::shader_check {

namespace fs = std::filesystem;

std::optional<std::string_view> FolderFiles::text(std::string_view path)
{
  const std::lock_guard lock(mutex_);
  auto found = texts_.find(path);
  if (found == texts_.end()) {
    const fs::path file = folder_ / path;
    std::optional<std::string> text;
    std::ifstream stream(file);
    // A folder opens, too.
    if (stream && fs::is_regular_file(file)) {
      std::ostringstream whole;
      whole << stream.rdbuf();
      text = whole.str();
    }
    found = texts_.emplace(path, std::move(text)).first;
  }
  return found->second ? std::optional<std::string_view>(*found->second) : std::nullopt;
}

}  // namespace gnomon::shader_check
