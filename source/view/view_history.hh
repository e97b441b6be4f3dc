// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <concepts>
#include <deque>
#include <utility>
#include <variant>
#include <vector>

namespace gnomon::view {

/**
 * Edits of one scene that can be undone: of nodes, lamps, cameras, materials and the world, and nodes that are added
 * and removed. Each keeps the values before and after it, so that undoing is an edit like any other. What comes back
 * has its old handle, so that animations, skins and other edits name it again. Nodes may be added and removed only by
 * this class; lamps, cameras, meshes and materials may not be removed.
 */
class History {
 public:
  /** More are forgotten, the oldest first, so that a long session does not take ever more memory. */
  static constexpr std::size_t change_max = 1000;

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
  /** Takes note of \a root, which was just added with its descendants. */
  void note_added(const scene::Scene &scene, scene::Handle<scene::Node> root);
  /** Removes \a root with its descendants. Their lamps, cameras and meshes stay in the scene. */
  void remove(scene::Scene &scene, scene::Handle<scene::Node> root);
  /** Further edits of the same thing are undone separately. Until then they are one, as a slider makes them. */
  void end_gesture()
  {
    is_in_gesture_ = false;
  }
  /** Undo what was edited since the last end_gesture, and forget it. */
  void revert_gesture(scene::Scene &scene);

  /** \return whether there was anything to undo, or to redo */
  bool undo(scene::Scene &scene);
  bool redo(scene::Scene &scene);
  /** The node that the last undo or redo brought back, with its descendants; an invalid handle: none. */
  [[nodiscard]] scene::Handle<scene::Node> restored() const
  {
    return restored_;
  }
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
  /** A node with its descendants, parents before their children. */
  struct SubtreeChange {
    struct Member {
      scene::Handle<scene::Node> node;
      scene::Handle<scene::Node> parent;
      scene::Node value;
    };
    std::vector<Member> members;
    /** The next child of the same parent; none if there is none. */
    scene::Handle<scene::Node> next;
    /** The change added them; otherwise it removed them. */
    bool is_addition = false;
  };
  using Change = std::variant<ThingChange<scene::Node>, ThingChange<scene::Lamp>, ThingChange<scene::Camera>,
                              ThingChange<scene::Material>, WorldChange, SubtreeChange>;

  /** The last change, if it is of that kind and of the same gesture; otherwise nullptr. */
  template <typename Kind>
  Kind *mergeable()
  {
    const bool is_last = is_in_gesture_ && done_count_ > 0 && done_count_ == changes_.size();
    return is_last ? std::get_if<Kind>(&changes_.back()) : nullptr;
  }
  void add(Change change);
  void apply(scene::Scene &scene, std::size_t index, bool is_undone);
  [[nodiscard]] static SubtreeChange subtree(const scene::Scene &scene, scene::Handle<scene::Node> root);
  static void remove_members(scene::Scene &scene, const SubtreeChange &change);
  void restore_members(scene::Scene &scene, const SubtreeChange &change);

  std::deque<Change> changes_;
  /** The others were undone. */
  std::size_t done_count_ = 0;
  bool is_in_gesture_ = false;
  scene::Handle<scene::Node> restored_{};
};

}  // namespace gnomon::view
