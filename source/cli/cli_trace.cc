// SPDX-License-Identifier: MIT
#include "cli_trace.hh"

#include "cli_output.hh"

#include "trace.hh"

#include <nlohmann/json.hpp>

#include <utility>

namespace gnomon::cli {

namespace {

/** Complete event ("ph": "X") of the Trace Event Format. Times are in microseconds. */
nlohmann::json complete_event(const std::string &name, double start_s, double duration_s, int thread)
{
  return {{"name", name}, {"ph", "X"},     {"ts", 1e6 * start_s}, {"dur", 1e6 * duration_s},
          {"pid", 1},     {"tid", thread}, {"cat", "gnomon"}};
}

}  // namespace

TraceFile::TraceFile(std::string path) : path_(std::move(path))
{
  if (!path_.empty()) {
    start_seconds_ = trace::process_seconds();
    trace::start();
  }
}

void TraceFile::write() const
{
  if (path_.empty()) {
    return;
  }
  nlohmann::json events = nlohmann::json::array();
  // Before there are threads, CPU time is the time since the start, but for waits for the disk.
  events.push_back(complete_event("process start and options", 0.0, start_seconds_, 0));
  for (const trace::Event &event : trace::events()) {
    events.push_back(complete_event(event.name, start_seconds_ + event.start_s, event.duration_s, event.thread));
    if (!event.detail.empty()) {
      events.back()["args"] = {{"of", event.detail}};
    }
  }
  write_json(path_, {{"traceEvents", std::move(events)}, {"displayTimeUnit", "ms"}}, 1);
}

}  // namespace gnomon::cli
