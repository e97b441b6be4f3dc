// SPDX-License-Identifier: MIT
#include "trace.hh"

#include <atomic>
#include <chrono>
#include <ctime>
#include <mutex>
#include <new>

namespace gnomon::trace {

namespace {

using Clock = std::chrono::steady_clock;

struct Log {
  std::mutex mutex;
  std::vector<Event> events;
  int thread_count = 0;
};

/** Not destroyed, because a thread may end its last span after the destructors of the process have run. */
Log &log()
{
  static Log *const instance = new Log;
  return *instance;
}

/** Ticks of Clock at start(). 0: nothing is recorded. */
std::atomic<Clock::rep> start_ticks = 0;

double seconds(Clock::rep ticks)
{
  return std::chrono::duration<double>(Clock::duration(ticks)).count();
}

/** Number of this thread. \pre the log is locked */
int thread_number()
{
  thread_local const int number = log().thread_count++;
  return number;
}

}  // namespace

void start()
{
  const std::lock_guard lock(log().mutex);
  static_cast<void>(thread_number());
  log().events.clear();
  start_ticks = Clock::now().time_since_epoch().count();
}

std::vector<Event> events()
{
  const std::lock_guard lock(log().mutex);
  return log().events;
}

double process_seconds()
{
  std::timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

Span::Span(std::string_view name, std::string_view detail) : name_(name)
{
  if (start_ticks.load(std::memory_order_relaxed) != 0) {
    begin_ticks_ = Clock::now().time_since_epoch().count();
    detail_ = detail;
  }
}

Span::~Span()
{
  if (begin_ticks_ == 0) {
    return;
  }
  const Clock::rep end_ticks = Clock::now().time_since_epoch().count();
  try {
    const std::lock_guard lock(log().mutex);
    // Otherwise start() was called meanwhile.
    if (begin_ticks_ >= start_ticks) {
      log().events.push_back({std::string(name_), std::move(detail_), seconds(begin_ticks_ - start_ticks),
                              seconds(end_ticks - begin_ticks_), thread_number()});
    }
  }
  catch (const std::bad_alloc &) {
    // Without memory the span is not recorded.
    return;
  }
}

}  // namespace gnomon::trace
