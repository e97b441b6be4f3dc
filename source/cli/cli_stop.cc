// SPDX-License-Identifier: MIT
#include "cli_stop.hh"

#include <chrono>
#include <csignal>

namespace gnomon::cli {

static volatile std::sig_atomic_t is_terminated = 0;

static double steady_seconds()
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

StopRequests::StopRequests(double seconds_max) : end_seconds_(steady_seconds() + seconds_max)
{
  is_terminated = 0;
  static_cast<void>(std::signal(SIGTERM, [](int) { is_terminated = 1; }));
}

StopRequests::~StopRequests()
{
  static_cast<void>(std::signal(SIGTERM, SIG_DFL));
}

bool StopRequests::is_stopped() const
{
  return is_terminated != 0 || steady_seconds() > end_seconds_;
}

std::string StopRequests::reason() const
{
  return is_terminated != 0 ? "SIGTERM" : "--stop-after";
}

}  // namespace gnomon::cli
