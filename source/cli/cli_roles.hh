// SPDX-License-Identifier: MIT
#pragma once

#include "output_roles.hh"

#include <sys/stat.h>
#include <unistd.h>
#include <cstdio>

namespace gnomon::cli {

/**
 * Roles of the files of a command. If an output is the pipe or file of standard output, as with `--json /dev/stdout`,
 * add_output also sends all further text for people to stderr.
 */
class Roles : public output::Roles {
 public:
  void add_output(const std::filesystem::path &path, const std::string &use)
  {
    output::Roles::add_output(path, use);
    struct stat file {};
    struct stat standard {};
    if (::stat(path.c_str(), &file) == 0 && ::fstat(STDOUT_FILENO, &standard) == 0 && file.st_dev == standard.st_dev &&
        file.st_ino == standard.st_ino && !S_ISCHR(file.st_mode)) {
      // The GNU C Library documents that it can be set.
      stdout = stderr;
    }
  }
};

}  // namespace gnomon::cli
