// SPDX-License-Identifier: MIT
#include "cli_output.hh"

#include <fmt/format.h>

#include <signal.h>
#include <unistd.h>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <fstream>
#include <stdexcept>

namespace gnomon::cli {

namespace fs = std::filesystem;

void write_atomically(const fs::path &path, const std::function<void(const fs::path &beside)> &write)
{
  // The extension remains last, because it selects the format.
  const fs::path beside =
      path.parent_path() / fmt::format(".{}.{}{}", path.stem().string(), getpid(), path.extension().string());
  try {
    write(beside);
    fs::rename(beside, path);
  }
  catch (const fs::filesystem_error &error) {
    std::error_code ignored;
    fs::remove(beside, ignored);
    throw std::runtime_error(fmt::format("{}: {}", path.string(), error.code().message()));
  }
  catch (...) {
    std::error_code ignored;
    fs::remove(beside, ignored);
    throw;
  }
}

void remove_unfinished(const fs::path &folder, const std::set<std::string> &names)
{
  std::error_code ignored;
  for (const fs::directory_entry &entry : fs::directory_iterator(folder.empty() ? "." : folder, ignored)) {
    // ".STEM.PROCESS.EXTENSION"; see write_atomically.
    const fs::path name = entry.path().filename();
    const fs::path stem = name.stem();
    const std::string process = stem.extension().string();
    pid_t id = 0;
    if (process.empty() ||
        std::from_chars(process.data() + 1, process.data() + process.size(), id).ptr !=
            process.data() + process.size() ||
        id <= 0 || stem.stem().string().front() != '.' ||
        !names.contains(stem.stem().string().substr(1) + name.extension().string())) {
      continue;
    }
    // Signal 0 only asks whether the process exists.
    if (kill(id, 0) != 0 && errno == ESRCH) {
      fs::remove(entry.path(), ignored);
    }
  }
}

NonFinite find_non_finite(glm::ivec2 size_px, std::span<const float> values, std::size_t channel_count)
{
  NonFinite found;
  const std::size_t row_size = std::size_t(size_px.x) * channel_count;
  // From the upper row down, the order in which a viewer reads the picture.
  for (int y = 0; y < size_px.y; y++) {
    const std::span<const float> row = values.subspan(std::size_t(size_px.y - 1 - y) * row_size, row_size);
    for (std::size_t i = 0; i < row.size(); i++) {
      if (!std::isfinite(row[i]) && found.count++ == 0) {
        found.first_px = {int(i / channel_count), y};
      }
    }
  }
  return found;
}

void write_text(const fs::path &path, const std::string &text)
{
  write_atomically(path, [&](const fs::path &beside) {
    std::ofstream file(beside);
    if (!(file << text << std::flush)) {
      throw std::runtime_error(fmt::format("{}: cannot be written", path.string()));
    }
  });
}

}  // namespace gnomon::cli
