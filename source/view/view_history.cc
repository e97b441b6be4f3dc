// SPDX-License-Identifier: MIT
#include "view_history.hh"

#include <algorithm>

namespace gnomon::view {

using scene::Handle;
using scene::Node;

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

History::SubtreeChange History::subtree(const scene::Scene &scene, Handle<Node> root)
{
  SubtreeChange change;
  change.members.push_back({root, scene.parent(root), scene.nodes()[root]});
  change.next = scene.next_sibling(root);
  for (std::size_t i = 0; i < change.members.size(); i++) {
    const Handle<Node> parent = change.members[i].node;
    for (Handle<Node> child = scene.first_child(parent); child; child = scene.next_sibling(child)) {
      change.members.push_back({child, parent, scene.nodes()[child]});
    }
  }
  return change;
}

void History::note_added(const scene::Scene &scene, Handle<Node> root)
{
  SubtreeChange change = subtree(scene, root);
  change.is_addition = true;
  add(std::move(change));
  end_gesture();
}

void History::remove(scene::Scene &scene, Handle<Node> root)
{
  SubtreeChange change = subtree(scene, root);
  remove_members(scene, change);
  add(std::move(change));
  end_gesture();
}

void History::remove_members(scene::Scene &scene, const SubtreeChange &change)
{
  // Remove the last node first, so that restored nodes have the same places in the scene's order.
  for (auto member = change.members.rbegin(); member != change.members.rend(); ++member) {
    scene.remove(member->node);
  }
}

void History::restore_members(scene::Scene &scene, const SubtreeChange &change)
{
  const Handle<Node> root = change.members.front().node;
  for (const SubtreeChange::Member &member : change.members) {
    scene.restore(member.node, member.value, member.parent, member.node == root ? change.next : Handle<Node>());
  }
  restored_.push_back(root);
}

void History::add(Change change)
{
  steps_.erase(steps_.begin() + std::ptrdiff_t(done_count_), steps_.end());
  if (is_step_open_) {
    steps_.back().push_back(std::move(change));
  }
  else {
    steps_.emplace_back().push_back(std::move(change));
    if (steps_.size() > step_max) {
      steps_.pop_front();
    }
  }
  done_count_ = steps_.size();
  is_in_gesture_ = true;
  is_step_open_ = is_joining_;
}

void History::apply(scene::Scene &scene, const Change &change, bool is_undone)
{
  if (const auto *subtree = std::get_if<SubtreeChange>(&change)) {
    if (subtree->is_addition == is_undone) {
      remove_members(scene, *subtree);
    }
    else {
      restore_members(scene, *subtree);
    }
    return;
  }
  std::visit(
      [&](const auto &one) {
        if constexpr (requires { one.thing; }) {
          scene.replace(one.thing, is_undone ? one.before : one.after);
        }
        else if constexpr (requires { one.before; }) {
          scene.set_world(is_undone ? one.before : one.after);
        }
      },
      change);
}

bool History::undo(scene::Scene &scene)
{
  restored_.clear();
  if (done_count_ == 0) {
    return false;
  }
  done_count_--;
  const Step &step = steps_[done_count_];
  std::for_each(step.rbegin(), step.rend(), [&](const Change &change) { apply(scene, change, true); });
  is_in_gesture_ = false;
  return true;
}

bool History::redo(scene::Scene &scene)
{
  restored_.clear();
  if (done_count_ == steps_.size()) {
    return false;
  }
  std::ranges::for_each(steps_[done_count_], [&](const Change &change) { apply(scene, change, false); });
  done_count_++;
  is_in_gesture_ = false;
  return true;
}

}  // namespace gnomon::view
