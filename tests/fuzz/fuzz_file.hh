// SPDX-License-Identifier: MIT
#pragma once

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

namespace gnomon::fuzz {

using Bytes = std::span<const std::uint8_t>;

/** A folder of this process in memory, removed when the process ends, for functions that read files. */
class Folder {
 public:
  Folder() : path_("/dev/shm/gnomon_fuzz." + std::to_string(::getpid()))
  {
    std::filesystem::create_directories(path_);
  }
  ~Folder()
  {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder &) = delete;
  Folder &operator=(const Folder &) = delete;

  /** Writes the file \a name. \return its path */
  std::filesystem::path write(const std::string &name, Bytes bytes) const
  {
    std::filesystem::path path = path_ / name;
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char *>(bytes.data()), std::streamsize(bytes.size()));
    return path;
  }
  [[nodiscard]] const std::filesystem::path &path() const
  {
    return path_;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace gnomon::fuzz
