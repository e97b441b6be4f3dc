// SPDX-License-Identifier: MIT
// Tables of resources by id, and a counter's difference, for all backends.
#pragma once

#include "gpu_error.hh"
#include "gpu_resource.hh"

#include <cstdint>
#include <utility>
#include <vector>

namespace gnomon::gpu {

/** Difference \a end - \a begin of a counter with \a bits bits that may have wrapped once; nanoseconds. */
[[nodiscard]] constexpr std::uint64_t elapsed_ticks(std::uint64_t begin, std::uint64_t end, int bits)
{
  const std::uint64_t mask = bits >= 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << unsigned(bits)) - 1;
  return (end - begin) & mask;
}

/** Objects of the backend, looked up by resource id. */
template <typename T>
class IdTable {
 public:
  explicit IdTable(ResourceKind kind) : kind_(kind) {}

  T &insert(ResourceId id, T value)
  {
    if (index_of(id) >= entries_.size()) {
      entries_.resize(index_of(id) + 1);
    }
    entries_[index_of(id)] = {id, std::move(value)};
    return entries_[index_of(id)].second;
  }
  /** \throws Error if \a id is 0 or the id of a destroyed resource */
  [[nodiscard]] T &at(ResourceId id)
  {
    if (id == 0 || index_of(id) >= entries_.size() || entries_[index_of(id)].first != id) {
      throw Error("{} id {} is stale or 0: there is no such resource", to_string(kind_), id);
    }
    return entries_[index_of(id)].second;
  }
  void erase(ResourceId id)
  {
    entries_[index_of(id)] = {};
  }

 private:
  ResourceKind kind_;
  std::vector<std::pair<ResourceId, T>> entries_;
};

}  // namespace gnomon::gpu
