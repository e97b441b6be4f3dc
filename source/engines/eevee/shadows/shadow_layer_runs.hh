// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::eevee {

/** Owner of layers: a lamp, or a lamp in one viewport. */
struct LayerOwner {
  /** ShadowLamp::key. */
  std::uint64_t lamp = 0;
  /** Of the viewport; 0: the layers serve all viewports. */
  std::uint64_t viewport = 0;

  bool operator==(const LayerOwner &) const = default;
};

/** Runs of layers in an array, each with one owner. A run keeps its first layer while its owner lives. */
class LayerRuns {
 public:
  /**
   * The first layer of \a owner's run, which has \a count layers afterwards. A run that has to grow, and cannot at its
   * place, gets another place. \a count 0 releases the run; the result is then 0.
   */
  int place(const LayerOwner &owner, int count);
  /** 0: \a owner has no run. */
  [[nodiscard]] int count_of(const LayerOwner &owner) const;
  /** Release the runs of all owners that are not in \a owners. */
  void keep_only(std::span<const LayerOwner> owners);
  /** Release all runs. */
  void clear()
  {
    runs_.clear();
  }
  /** One past the last layer in use: the layers that the array must have. */
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
