// SPDX-License-Identifier: MIT
#pragma once

#include "output_file.hh"

#include <map>

namespace gnomon::output {

/** Thrown where one file would be read and written, or written twice. The message names both uses. */
struct Conflict : Error {
  using Error::Error;
};

/**
 * The files that one command reads and writes. A file is the same under all spellings, links and hard links (file_id).
 * Character devices may have any number of uses.
 */
class Roles {
 public:
  /**
   * A file that is read. Files that do not exist are ignored. \a use: for messages: "the scene", "--world"
   * \throws Conflict if it is an output
   */
  void add_input(const std::filesystem::path &path, const std::string &use);
  /**
   * A file that will be written; an empty path is none. \throws Conflict if it is an input or another output; Error, as
   * check_writable
   */
  void add_output(const std::filesystem::path &path, const std::string &use);
  /** Whether an output is the file that \a path leads to. False for character devices. */
  [[nodiscard]] bool has_output(const std::filesystem::path &path) const;

 private:
  struct Role {
    std::string text;
    bool is_output;
  };
  std::map<FileId, Role> roles_;
};

}  // namespace gnomon::output
