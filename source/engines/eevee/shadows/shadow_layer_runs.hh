// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace gnomon::eevee {

/** Runs of layers in an array, each owned by a key. A run keeps its first layer while its owner lives. */
class LayerRuns {
 public:
  /**
   * The first layer of \a key's run, which has \a count layers afterwards. A run that has to grow, and cannot at its
   * place, gets another place. \a count 0 releases the run; the result is then 0.
   */
  int place(std::uint64_t key, int count);
  /** 0: \a key has no run. */
  [[nodiscard]] int count_of(std::uint64_t key) const;
  /** Release the runs of all keys that are not in \a keys. */
  void keep_only(std::span<const std::uint64_t> keys);
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
    std::uint64_t key = 0;
    int first = 0;
    int count = 0;
  };
  /** In order of `first`. */
  std::vector<Run> runs_;
};

}  // namespace gnomon::eevee
