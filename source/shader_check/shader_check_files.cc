// SPDX-License-Identifier: MIT
#include "shader_check_files.hh"

#include "shader_check.hh"

#include <algorithm>
#include <fstream>

namespace gnomon::shader_check {

namespace fs = std::filesystem;

std::optional<std::string_view> FolderFiles::text(std::string_view path)
{
  const std::lock_guard lock(mutex_);
  auto found = texts_.find(path);
  if (found == texts_.end()) {
    const fs::path file = folder_ / path;
    std::optional<std::string> text;
    // A folder opens, too, and a pipe may never have an end.
    std::error_code error;
    std::ifstream stream;
    if (fs::is_regular_file(file, error)) {
      stream.open(file);
    }
    if (stream.is_open()) {
      // A longer file is refused, so that its rest is not needed.
      std::string whole(std::min<std::uintmax_t>(fs::file_size(file, error), stage_bytes_max + 1), '\0');
      stream.read(whole.data(), std::streamsize(whole.size()));
      whole.resize(std::size_t(stream.gcount()));
      text = std::move(whole);
    }
    found = texts_.emplace(path, std::move(text)).first;
  }
  return found->second ? std::optional<std::string_view>(*found->second) : std::nullopt;
}

}  // namespace gnomon::shader_check
