// SPDX-License-Identifier: MIT
#pragma once

#include <string>

/** \file Option --trace. */
namespace gnomon::cli {

/** Times of the parts of the process so far, in Chrome's trace format. */
class TraceFile {
 public:
  /** Spans are recorded from now on. \a path: empty for none */
  explicit TraceFile(std::string path);
  /** Writes the file atomically. \throws std::runtime_error naming the path if it cannot be written. */
  void write() const;

 private:
  std::string path_;
  /** CPU time of the process until the construction, s. */
  double start_seconds_ = 0.0;
};

}  // namespace gnomon::cli
