// SPDX-License-Identifier: MIT
#include "measure_start.hh"

#include "gltf_export.hh"
#include "internal/measure_bench_meshes.hh"
#include "internal/measure_temporary_folder.hh"
#include "measure_left_out.hh"

#include <fmt/format.h>

#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <algorithm>
#include <cstring>
#include <stdexcept>

extern char **environ;

namespace gnomon::measure {

namespace fs = std::filesystem;

namespace {

using Words = std::vector<std::string>;

std::vector<char *> pointers(Words &words)
{
  std::vector<char *> result;
  for (std::string &word : words) {
    result.push_back(word.data());
  }
  result.push_back(nullptr);
  return result;
}

/** This process's environment, with the caches of Gnomon and Mesa in \a folder. */
Words environment(const fs::path &folder)
{
  Words words;
  for (char **word = environ; *word != nullptr; word++) {
    const std::string_view text(*word);
    if (!text.starts_with("XDG_CACHE_HOME=") && !text.starts_with("MESA_SHADER_CACHE_DIR=")) {
      words.emplace_back(text);
    }
  }
  words.push_back("XDG_CACHE_HOME=" + folder.string());
  words.push_back("MESA_SHADER_CACHE_DIR=" + folder.string());
  return words;
}

struct Finished {
  double seconds = 0.0;
  std::size_t peak_bytes = 0;
};

/** Runs a command with its output dropped. */
Finished run(Words command, const fs::path &cache_folder)
{
  Words variables = environment(cache_folder);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int output : {1, 2}) {
    posix_spawn_file_actions_addopen(&actions, output, "/dev/null", O_WRONLY, 0);
  }
  const double start = now(Clock::Wall);
  pid_t process = 0;
  const int error = posix_spawn(&process, command[0].c_str(), &actions, nullptr, pointers(command).data(),
                                pointers(variables).data());
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw std::runtime_error(fmt::format("{}: {}", command[0], std::strerror(error)));
  }
  int status = 0;
  rusage used{};
  while (wait4(process, &status, 0, &used) < 0 && errno == EINTR) {
  }
  const double end = now(Clock::Wall);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw std::runtime_error(fmt::format("{}: failed", fmt::join(command, " ")));
  }
  return {end - start, std::size_t(used.ru_maxrss) * 1024};
}

}  // namespace

std::vector<StartCost> measure_start(const StartSettings &settings)
{
  const TemporaryFolder folder;
  fs::path scene = settings.scene;
  if (scene.empty()) {
    scene = folder.path / "scene.glb";
    gltf::export_gltf(left_out_cases().front().scene, scene);
  }
  const std::string program = settings.program.string();
  Words render = {program,
                  "render",
                  scene.string(),
                  "--size",
                  "640x360",
                  "--samples",
                  "1",
                  "--backend",
                  settings.backend,
                  "-o",
                  (folder.path / "picture.exr").string()};
  Words info = {program, "info", scene.string()};
  for (Words *const command : {&info, &render}) {
    command->insert(command->end(), settings.scene_arguments.begin(), settings.scene_arguments.end());
  }
  struct Case {
    const char *what;
    Words command;
    bool has_empty_caches;
  };
  const std::vector<Case> cases = {{"/bin/true", {"/bin/true"}, false},
                                   {"--version", {program, "--version"}, false},
                                   {"info", info, false},
                                   {"render, filled caches", render, false},
                                   {"render, empty caches", render, true}};
  std::vector<StartCost> costs;
  for (const Case &one : cases) {
    costs.push_back({one.what, {}, 0});
  }
  for (int round = 0; round <= settings.rounds; round++) {
    for (std::size_t i = 0; i < cases.size(); i++) {
      const fs::path caches = folder.path / (cases[i].has_empty_caches ? "empty" : "filled");
      if (cases[i].has_empty_caches) {
        fs::remove_all(caches);
      }
      fs::create_directories(caches);
      const Finished finished = run(cases[i].command, caches);
      // The first fills the caches.
      if (round > 0) {
        costs[i].seconds.push_back(finished.seconds);
        costs[i].peak_bytes = std::max(costs[i].peak_bytes, finished.peak_bytes);
      }
    }
  }
  return costs;
}

}  // namespace gnomon::measure
