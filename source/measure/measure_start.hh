// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

/** The benchmark `gnomon bench start`: whole processes, from their creation to their end. */
namespace gnomon::measure {

struct StartCost {
  std::string what;
  /** One time for each round, wall clock. */
  std::vector<double> seconds;
  /** Largest resident memory of all rounds. The system counts that of the measuring process before the start, too. */
  std::size_t peak_bytes = 0;
};

struct StartSettings {
  /** The file of the program `gnomon`. */
  std::filesystem::path program;
  /** A glTF file; empty: a scene made in place. */
  std::filesystem::path scene;
  /** Further arguments of `info` and `render`, for the scene's light. */
  std::vector<std::string> scene_arguments;
  /** "gl", or "null": without a driver. */
  std::string backend = "gl";
  int rounds = 21;
};

/**
 * Runs, in turn in each round: /bin/true, which is the cost of a process; the program's `--version`; `info`; and
 * `render` of one sample at 640x360, with the caches of shaders filled and empty. A first round is not measured. The
 * caches are in a temporary folder: those of the user are neither used nor changed.
 *
 * \throws std::runtime_error if a process fails.
 */
[[nodiscard]] std::vector<StartCost> measure_start(const StartSettings &settings);

}  // namespace gnomon::measure
