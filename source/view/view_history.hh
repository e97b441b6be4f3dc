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
 * Undo history of one scene: edits of nodes, lamps, cameras, materials and the world, and added and removed nodes. Each
 * edit stores the values before and after it; undo is an ordinary edit. A restored node has its old handle, so that
 * animations, skins and other edits refer to it again. Nodes may be added and removed only through this class; lamps,
 * cameras, meshes and materials may not be removed.
 */
class History {
 public:
  /** Maximum number of undo steps; the oldest are dropped first. This bounds the memory of a long session. */
  static constexpr std::size_t step_max = 1000;

  /** Edit \a thing by \a change and record the edit. \throws as scene::Scene::edit; nothing changes then */
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
  /** Record the addition of \a root with its descendants, just after it was added. */
  void note_added(const scene::Scene &scene, scene::Handle<scene::Node> root);
  /** Remove \a root with its descendants. Their lamps, cameras and meshes stay in the scene. */
  void remove(scene::Scene &scene, scene::Handle<scene::Node> root);
  /** All changes of \a work are one undo step. */
  template <std::invocable Work>
  void join(Work &&work)
  {
    const Joining joining(*this);
    work();
  }
  /** End a gesture. Edits of one thing within a gesture, as by a slider, are one undo step. */
  void end_gesture()
  {
    is_in_gesture_ = false;
  }

  /** \return whether there was a step to undo, or to redo */
  bool undo(scene::Scene &scene);
  bool redo(scene::Scene &scene);
  /** Root nodes that the last undo or redo restored. */
  [[nodiscard]] const std::vector<scene::Handle<scene::Node>> &restored() const
  {
    return restored_;
  }
  [[nodiscard]] std::size_t undo_count() const
  {
    return done_count_;
  }
  [[nodiscard]] std::size_t redo_count() const
  {
    return steps_.size() - done_count_;
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
    /** Next child of the same parent. Invalid handle: none. */
    scene::Handle<scene::Node> next;
    /** The change added the nodes. False: it removed them. */
    bool is_addition = false;
  };
  using Change = std::variant<ThingChange<scene::Node>, ThingChange<scene::Lamp>, ThingChange<scene::Camera>,
                              ThingChange<scene::Material>, WorldChange, SubtreeChange>;
  using Step = std::vector<Change>;

  /** While it exists, changes are added to one step. */
  class Joining {
   public:
    explicit Joining(History &history) : history_(history)
    {
      history_.end_gesture();
      history_.is_joining_ = true;
    }
    ~Joining()
    {
      history_.end_gesture();
      history_.is_joining_ = false;
      history_.is_step_open_ = false;
    }
    Joining(const Joining &) = delete;
    Joining &operator=(const Joining &) = delete;

   private:
    History &history_;
  };

  /** The last change if it is of type \a Kind and belongs to the current gesture; otherwise nullptr. */
  template <typename Kind>
  Kind *mergeable()
  {
    const bool is_last = is_in_gesture_ && done_count_ > 0 && done_count_ == steps_.size();
    return is_last ? std::get_if<Kind>(&steps_.back().back()) : nullptr;
  }
  void add(Change change);
  void apply(scene::Scene &scene, const Change &change, bool is_undone);
  [[nodiscard]] static SubtreeChange subtree(const scene::Scene &scene, scene::Handle<scene::Node> root);
  static void remove_members(scene::Scene &scene, const SubtreeChange &change);
  void restore_members(scene::Scene &scene, const SubtreeChange &change);

  /** None is empty. */
  std::deque<Step> steps_;
  /** Number of steps that are applied; the later ones were undone. */
  std::size_t done_count_ = 0;
  bool is_in_gesture_ = false;
  bool is_joining_ = false;
  /** The next change belongs to the last step. */
  bool is_step_open_ = false;
  std::vector<scene::Handle<scene::Node>> restored_;
};

}  // namespace gnomon::view
