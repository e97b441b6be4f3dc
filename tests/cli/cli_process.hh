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
  /** Exit status; the negated signal number if a signal ended the process. */
  int status = 0;
  std::string out;
  std::string err;
};

/** Runs the program under test in a temporary folder, which is removed after the test. */
class ProgramTest : public testing::Test {
 protected:
  ProgramTest()
  {
    std::string pattern = (std::filesystem::temp_directory_path() / "gnomon.XXXXXX").string();
    folder = mkdtemp(pattern.data());
    // A cache in the build folder, so that the user's cache is not changed.
    setenv("XDG_CACHE_HOME", (std::filesystem::path(GNOMON_PROGRAM).parent_path() / "cache").c_str(), 1);
  }
  ~ProgramTest() override
  {
    std::filesystem::remove_all(folder);
  }

  /** Runs the program. \a arguments are parsed by a shell. */
  Finished run(const std::string &arguments, const std::filesystem::path &program = GNOMON_PROGRAM)
  {
    const std::string command = "cd '" + folder.string() + "' && '" + program.string() + "' " + arguments +
                                " > stdout.txt 2> stderr.txt < /dev/null";
    const int status = std::system(command.c_str());
    Finished finished;
    finished.status = WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
    // A shell reports a signal as 128 + its number.
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
  /** The files in the folder, except those that run() creates. */
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

/** A glTF file: a white metal of roughness 1 in the plane y = 0, under a sun of 2 W/m². */
inline constexpr const char *rough_metal_gltf = R"({"asset":{"version":"2.0"},
  "extensionsUsed":["KHR_lights_punctual"],
  "extensions":{"KHR_lights_punctual":{"lights":[{"type":"directional","intensity":1366}]}},
  "buffers":[{"uri":"data:application/octet-stream;base64,AACAvwAAAAAAAIA/AACAPwAAAAAAAIA/AAAAAAAAAAAAAIC/","byteLength":36}],
  "bufferViews":[{"buffer":0,"byteLength":36}],
  "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[-1,0,-1],"max":[1,0,1]}],
  "materials":[{"doubleSided":true}],
  "meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
  "nodes":[{"mesh":0},{"rotation":[-0.70710678,0,0,0.70710678],"extensions":{"KHR_lights_punctual":{"light":0}}}],
  "scenes":[{"nodes":[0,1]}],"scene":0})";

/** The same plane with two variants of its material. */
inline const std::string variants_gltf = [] {
  std::string text = rough_metal_gltf;
  const auto replace = [&text](const std::string &before, const std::string &after) {
    text.replace(text.find(before), before.size(), after);
  };
  replace(R"("KHR_lights_punctual"])", R"("KHR_lights_punctual","KHR_materials_variants"])");
  replace(R"("extensions":{"KHR)",
          R"("extensions":{"KHR_materials_variants":{"variants":[{"name":"red"},{"name":"blue"}]},"KHR)");
  replace(R"("material":0)", R"("material":0,"extensions":{"KHR_materials_variants":{"mappings":[
    {"material":0,"variants":[0]},{"material":1,"variants":[1]}]}})");
  replace(R"({"doubleSided":true})", R"({"doubleSided":true},{"pbrMetallicRoughness":{"baseColorFactor":[0,0,1,1]}})");
  return text;
}();

/** A scene of the repository. */
inline std::string example(const std::string &name)
{
  return "'" GNOMON_SOURCE "/examples/scenes/" + name + ".glb'";
}

}  // namespace gnomon::test
