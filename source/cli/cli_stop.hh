// SPDX-License-Identifier: MIT
#pragma once

#include <limits>
#include <string>

namespace gnomon::cli {

/**
 * Requests to end the work early: SIGTERM, and the time of --stop-after. The command asks for them after each sample.
 * At most one exists at a time.
 */
class StopRequests {
 public:
  /** SIGTERM no longer ends the process. \a seconds_max: time from now until a request; infinity: none */
  explicit StopRequests(double seconds_max = std::numeric_limits<double>::infinity());
  /** SIGTERM ends the process again. */
  ~StopRequests();
  StopRequests(const StopRequests &) = delete;
  StopRequests &operator=(const StopRequests &) = delete;

  /** May be called on any thread. */
  [[nodiscard]] bool is_stopped() const;
  /** "SIGTERM" or "--stop-after". \pre is_stopped() */
  [[nodiscard]] std::string reason() const;

 private:
  /** On the steady clock, seconds. */
  double end_seconds_;
};

}  // namespace gnomon::cli
