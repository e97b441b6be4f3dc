// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <concepts>
#include <variant>
#include <vector>

namespace gnomon::view {

/**
 * Edits of one scene that can be undone: of nodes, lamps, materials and the world. Each keeps the value before and
 * after it, so that undoing is an edit like any other. What it edits may not be removed from the scene.
 */
class History {
 public:
  /** Changes a thing by \a change, as scene::Scene::edit, and takes note of it. \throws as that; nothing changes. */
  template <typename T, std::invocable<T &> Change>
  void edit(scene::Scene &scene, scene::Handle<T> thing, Change &&change)
  {
    const T before = scene.pool<T>()[thing];
    T after = before;
    change(after);
    const scene::Revision revision = scene.revision();
    scene.replace(thing, after);
    if (scene.revision() == revision) {
      return;
    }
    if (auto *last = mergeable<ThingChange<T>>(); last && last->thing == thing) {
      last->after = std::move(after);
      return;
    }
    add(ThingChange<T>{thing, before, std::move(after)});
  }
  void set_world(scene::Scene &scene, std::optional<scene::World> world);
  /** Further edits of the same thing are undone separately. Until then they are one, as a slider makes them. */
  void end_gesture()
  {
    is_in_gesture_ = false;
  }

  /** \return whether there was anything to undo, or to redo */
  bool undo(scene::Scene &scene);
  bool redo(scene::Scene &scene);
  [[nodiscard]] std::size_t undo_count() const
  {
    return done_count_;
  }
  [[nodiscard]] std::size_t redo_count() const
  {
    return changes_.size() - done_count_;
  }

 private:
  template <typename T>
  struct ThingChange {
    scene::Handle<T> thing;
    T before;
    T after;
  };
  struct WorldChange {
    std::optional<scene::World> before;
    std::optional<scene::World> after;
  };
  using Change =
      std::variant<ThingChange<scene::Node>, ThingChange<scene::Lamp>, ThingChange<scene::Material>, WorldChange>;

  /** The last change, if it is of that kind and of the same gesture; otherwise nullptr. */
  template <typename Kind>
  Kind *mergeable()
  {
    const bool is_last = is_in_gesture_ && done_count_ > 0 && done_count_ == changes_.size();
    return is_last ? std::get_if<Kind>(&changes_.back()) : nullptr;
  }
  void add(Change change);
  static void apply(scene::Scene &scene, const Change &change, bool is_undone);

  std::vector<Change> changes_;
  /** The others were undone. */
  std::size_t done_count_ = 0;
  bool is_in_gesture_ = false;
};

}  // namespace gnomon::view
