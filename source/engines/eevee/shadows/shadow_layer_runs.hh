// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::eevee {

/** Owner of a run of layers: a lamp, or a lamp in one viewport. */
struct LayerOwner {
  /** ShadowLamp::key. */
  std::uint64_t lamp = 0;
  /** Identity of the viewport. 0: all viewports share the layers. */
  std::uint64_t viewport = 0;

  bool operator==(const LayerOwner &) const = default;
};

/** Allocates runs of consecutive layers of an array texture. Each run has one owner. */
class LayerRuns {
 public:
  /**
   * Set the size of \a owner's run to \a count layers, or create the run. A run keeps its first layer, unless it has to
   * grow and the next layers are in use. \a count 0 releases the run.
   * \return the first layer of the run; 0 if \a count is 0.
   */
  int place(const LayerOwner &owner, int count);
  /** Number of layers of \a owner's run; 0 if there is none. */
  [[nodiscard]] int count_of(const LayerOwner &owner) const;
  /** Release the runs of all owners that are not in \a owners. */
  void keep_only(std::span<const LayerOwner> owners);
  /** Release all runs. */
  void clear()
  {
    runs_.clear();
  }
  /** One past the last layer in use: the number of layers that the array needs. */
  [[nodiscard]] int end() const
  {
    return runs_.empty() ? 0 : runs_.back().first + runs_.back().count;
  }

 private:
  struct Run {
    LayerOwner owner;
    int first = 0;
    int count = 0;
  };
  /** In order of `first`. */
  std::vector<Run> runs_;
};

}  // namespace gnomon::eevee
