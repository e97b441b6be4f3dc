// SPDX-License-Identifier: MIT
// Runs work in processes of its own, so that no input can stop, fill or end this one.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace gnomon::cli {

struct WorkLimits {
  /** Most CPU time for one job, so that a busy machine fails none. It may wait 20 times as long. */
  double seconds = 60.0;
  /** Most memory that a process may write. */
  std::size_t memory_bytes = std::size_t(3) << 30U;
};

struct WorkResult {
  /** The result of the job. */
  std::string bytes;
  /** Why it returned nothing: a clause; empty: it returned. */
  std::string failure;
  /** Whether it ended its process. */
  bool is_crash = false;
};

/**
 * Calls \a work once with each index from 0 to count - 1, in any order, in one process for each processor. A process is
 * a copy of this one whose standard output goes nowhere; a job that breaks a limit or crashes ends its process only.
 *
 * Call it before this process starts threads. \a progress is called after each job with the number of finished jobs.
 */
[[nodiscard]] std::vector<WorkResult> run_in_workers(std::size_t count, const WorkLimits &limits,
                                                     const std::function<std::string(std::size_t index)> &work,
                                                     const std::function<void(std::size_t done)> &progress);

}  // namespace gnomon::cli
