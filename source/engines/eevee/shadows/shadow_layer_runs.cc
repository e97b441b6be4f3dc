// SPDX-License-Identifier: MIT
#include "shadow_layer_runs.hh"

#include <algorithm>

namespace gnomon::eevee {

int LayerRuns::place(const LayerOwner &owner, int count)
{
  const auto own = std::ranges::find(runs_, owner, &Run::owner);
  if (own != runs_.end() && count > 0) {
    const auto next = own + 1;
    if (count <= own->count || next == runs_.end() || own->first + count <= next->first) {
      own->count = count;
      return own->first;
    }
  }
  if (own != runs_.end()) {
    runs_.erase(own);
  }
  if (count == 0) {
    return 0;
  }
  int first = 0;
  auto next = runs_.begin();
  while (next != runs_.end() && next->first < first + count) {
    first = next->first + next->count;
    next++;
  }
  runs_.insert(next, {owner, first, count});
  return first;
}

int LayerRuns::count_of(const LayerOwner &owner) const
{
  const auto own = std::ranges::find(runs_, owner, &Run::owner);
  return own == runs_.end() ? 0 : own->count;
}

void LayerRuns::keep_only(std::span<const LayerOwner> owners)
{
  std::erase_if(runs_, [&](const Run &run) { return std::ranges::find(owners, run.owner) == owners.end(); });
}

}  // namespace gnomon::eevee
