// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/**
 * Times of the parts of a process: import, creation of the device, compilation of each program, each frame.
 *
 * Any thread may make a Span. While nothing is recorded, a span costs one atomic load.
 */
namespace gnomon::trace {

/** A part of the work of one thread. */
struct Event {
  std::string name;
  /** The object of the work, for example a file or a program; may be empty. */
  std::string detail;
  /** Since start(), s. */
  double start_s = 0.0;
  double duration_s = 0.0;
  /** 0 for the thread that first called start(), then 1, 2, ... */
  int thread = 0;
};

/** Discard the events, and record the spans of all threads that begin from now on. Until the process ends. */
void start();

/** The spans that have ended since start(), in the order of their ends. */
[[nodiscard]] std::vector<Event> events();

/** CPU time of all threads of the process until now, s. */
[[nodiscard]] double process_seconds();

/** Records the time from its construction to its destruction, on one thread. */
class Span {
 public:
  /** \a name: must exist as long as the span. \a detail: the object of the work; copied if spans are recorded. */
  explicit Span(std::string_view name, std::string_view detail = {});
  ~Span();
  Span(const Span &) = delete;
  Span &operator=(const Span &) = delete;

 private:
  std::string_view name_;
  std::string detail_;
  /** Ticks of the steady clock; 0 if spans were not recorded when this one began. */
  std::int64_t begin_ticks_ = 0;
};

}  // namespace gnomon::trace
