// SPDX-License-Identifier: MIT
#include "view_history.hh"

namespace gnomon::view {

void History::set_world(scene::Scene &scene, std::optional<scene::World> world)
{
  const std::optional<scene::World> before = scene.world();
  if (before == world) {
    return;
  }
  scene.set_world(world);
  if (auto *last = mergeable<WorldChange>()) {
    last->after = std::move(world);
    return;
  }
  add(WorldChange{before, std::move(world)});
}

void History::add(Change change)
{
  changes_.erase(changes_.begin() + std::ptrdiff_t(done_count_), changes_.end());
  changes_.push_back(std::move(change));
  done_count_ = changes_.size();
  is_in_gesture_ = true;
}

void History::apply(scene::Scene &scene, const Change &change, bool is_undone)
{
  std::visit(
      [&](const auto &one) {
        const auto &value = is_undone ? one.before : one.after;
        if constexpr (requires { one.thing; }) {
          scene.replace(one.thing, value);
        }
        else {
          scene.set_world(value);
        }
      },
      change);
}

bool History::undo(scene::Scene &scene)
{
  if (done_count_ == 0) {
    return false;
  }
  apply(scene, changes_[done_count_ - 1], true);
  done_count_--;
  is_in_gesture_ = false;
  return true;
}

bool History::redo(scene::Scene &scene)
{
  if (done_count_ == changes_.size()) {
    return false;
  }
  apply(scene, changes_[done_count_], false);
  done_count_++;
  is_in_gesture_ = false;
  return true;
}

}  // namespace gnomon::view
