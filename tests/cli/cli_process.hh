// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace gnomon::test {

struct Finished {
  /** Exit status; negative: the signal that ended it. */
  int status = 0;
  std::string out;
  std::string err;
};

/** Runs the program under test in a folder of its own, which goes with the test. */
class ProgramTest : public testing::Test {
 protected:
  ProgramTest()
  {
    std::string pattern = (std::filesystem::temp_directory_path() / "gnomon.XXXXXX").string();
    folder = mkdtemp(pattern.data());
    // Not the user's: compiled shaders stay with the build.
    setenv("XDG_CACHE_HOME", (std::filesystem::path(GNOMON_PROGRAM).parent_path() / "cache").c_str(), 1);
  }
  ~ProgramTest() override
  {
    std::filesystem::remove_all(folder);
  }

  /** \a arguments as a shell reads them. */
  Finished run(const std::string &arguments)
  {
    const std::string command =
        "cd '" + folder.string() + "' && '" GNOMON_PROGRAM "' " + arguments + " > stdout.txt 2> stderr.txt < /dev/null";
    const int status = std::system(command.c_str());
    Finished finished;
    finished.status = WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
    // A shell reports a child's signal as 128 and its number.
    finished.status = finished.status > 128 ? 128 - finished.status : finished.status;
    finished.out = read("stdout.txt");
    finished.err = read("stderr.txt");
    return finished;
  }
  std::string read(const std::string &name) const
  {
    std::ifstream file(folder / name);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  }
  void write(const std::string &name, const std::string &text) const
  {
    std::ofstream(folder / name) << text;
  }
  /** Files but those of run(). */
  std::size_t file_count() const
  {
    std::size_t count = 0;
    for (const auto &entry : std::filesystem::directory_iterator(folder)) {
      count += entry.path().filename() != "stdout.txt" && entry.path().filename() != "stderr.txt";
    }
    return count;
  }

  std::filesystem::path folder;
};

/** A scene of the repository. */
inline std::string example(const std::string &name)
{
  return "'" GNOMON_SOURCE "/examples/scenes/" + name + ".glb'";
}

}  // namespace gnomon::test
