// SPDX-License-Identifier: MIT
#pragma once

#include "gltf_import.hh"

#include <algorithm>
#include <cstddef>
#include <exception>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** Thrown by Progress if ImportOptions::progress returns false. */
struct Cancelled : std::exception {};

/** Calls ImportOptions::progress for the steps of an import, on the importing thread. */
class Progress {
 public:
  /** \a report must outlive the object. It may be empty. */
  explicit Progress(const ReportProgress &report) : report_(report) {}

  /** Begin a phase of \a step_count steps, at whose end \a end of the import is done. \throws Cancelled */
  void begin_phase(std::size_t step_count, float end)
  {
    begin_ = end_;
    end_ = end;
    step_count_ = step_count;
    done_ = 0;
    report(begin_);
  }
  /** \a done: steps of the phase so far; more than there are count as all. \throws Cancelled */
  void set_done(std::size_t done)
  {
    done_ = done;
    const float share = float(std::min(done, step_count_)) / float(std::max<std::size_t>(step_count_, 1));
    const float part = begin_ + (end_ - begin_) * share;
    // A call for each of a million nodes would take longer than the nodes.
    if (part - reported_ >= 1.0F / 256.0F) {
      report(part);
    }
  }
  void step()
  {
    set_done(done_ + 1);
  }
  void finish()
  {
    report(1.0F);
  }

 private:
  void report(float part)
  {
    reported_ = part;
    if (report_ && !report_(part)) {
      throw Cancelled();
    }
  }

  const ReportProgress &report_;
  float begin_ = 0.0F;
  float end_ = 0.0F;
  float reported_ = 0.0F;
  std::size_t step_count_ = 0;
  std::size_t done_ = 0;
};

}  // namespace gnomon::gltf
