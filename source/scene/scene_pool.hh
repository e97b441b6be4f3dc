// SPDX-License-Identifier: MIT
#pragma once

#include "scene_handle.hh"

#include <algorithm>
#include <array>
#include <cstddef>
#include <deque>
#include <iterator>
#include <limits>
#include <vector>

namespace gnomon::scene {

/**
 * The things of one type, by handle, with a revision for each aspect of each thing. Read-only; Scene writes it.
 *
 * Requires `enum class T::Aspect { …, Count }` and `static constexpr std::string_view T::kind_name`. References stay
 * valid while other things are added and removed. Iteration is in the order of addition, except that a new thing may
 * take the position of a removed one.
 */
template <typename T>
class Pool {
 public:
  using Aspect = typename T::Aspect;

  /** \throws StaleHandle if \a handle is not valid in this pool. */
  const T &operator[](Handle<T> handle) const
  {
    return slot(handle).value;
  }
  /** nullptr if \a handle is not valid in this pool. */
  [[nodiscard]] const T *find(Handle<T> handle) const
  {
    return is_live(handle) ? &slots_[handle.index].value : nullptr;
  }
  [[nodiscard]] bool is_live(Handle<T> handle) const
  {
    return handle && handle.index < slots_.size() && slots_[handle.index].is_live &&
           slots_[handle.index].generation == handle.generation;
  }
  /** Whether the pool has or had the thing of \a handle. */
  [[nodiscard]] bool was_added(Handle<T> handle) const
  {
    return handle && handle.index < slots_.size() && handle.generation <= slots_[handle.index].last_generation;
  }
  /** Whether the pool had the thing of \a handle, and its index is free. */
  [[nodiscard]] bool is_restorable(Handle<T> handle) const
  {
    return was_added(handle) && !slots_[handle.index].is_live;
  }
  [[nodiscard]] std::size_t size() const
  {
    return slots_.size() - removed_.size();
  }
  [[nodiscard]] bool empty() const
  {
    return size() == 0;
  }
  /** Above all values of Handle::index in the pool: the size of an array indexed by them. */
  [[nodiscard]] std::size_t index_end() const
  {
    return slots_.size();
  }

  /**
   * Last change of an aspect of one thing. Adding the thing changes all its aspects; constructing or assigning the
   * scene changes all aspects of all things. \throws StaleHandle
   */
  [[nodiscard]] Revision revision(Handle<T> handle, Aspect aspect) const
  {
    return first_revision_.or_later(slot(handle).revisions[std::size_t(aspect)]);
  }
  /** Last change of the aspect of any thing; adding and removing a thing changes all aspects. */
  [[nodiscard]] Revision latest(Aspect aspect) const
  {
    return first_revision_.or_later(latest_[std::size_t(aspect)]);
  }
  /** Last change of any aspect of any thing. */
  [[nodiscard]] Revision latest() const
  {
    return first_revision_.or_later(*std::max_element(latest_.begin(), latest_.end()));
  }

  struct Item {
    Handle<T> handle;
    const T &value;
  };
  /** A std::forward_iterator over the pool's Items, which it makes when it is dereferenced. */
  class Iterator {
   public:
    using value_type = Item;
    using difference_type = std::ptrdiff_t;
    using reference = Item;
    using iterator_concept = std::forward_iterator_tag;
    /** Before C++20, only an iterator over references could be more. */
    using iterator_category = std::input_iterator_tag;
    /** Holds the Item during `iterator->value`. */
    struct pointer {
      Item item;
      const Item *operator->() const
      {
        return &item;
      }
    };

    Iterator() = default;
    Iterator(const Pool &pool, std::size_t index) : pool_(&pool), index_(index)
    {
      skip_removed();
    }
    Item operator*() const
    {
      const Slot &slot = pool_->slots_[index_];
      return {{std::uint32_t(index_), slot.generation}, slot.value};
    }
    pointer operator->() const
    {
      return {**this};
    }
    Iterator &operator++()
    {
      index_++;
      skip_removed();
      return *this;
    }
    Iterator operator++(int)
    {
      const Iterator before = *this;
      ++*this;
      return before;
    }
    bool operator==(const Iterator &) const = default;

   private:
    void skip_removed()
    {
      while (index_ < pool_->slots_.size() && !pool_->slots_[index_].is_live) {
        index_++;
      }
    }
    const Pool *pool_ = nullptr;
    std::size_t index_ = 0;
  };
  [[nodiscard]] Iterator begin() const
  {
    return {*this, 0};
  }
  [[nodiscard]] Iterator end() const
  {
    return {*this, slots_.size()};
  }
  /** The first thing in iteration order; an invalid handle if the pool is empty. */
  [[nodiscard]] Handle<T> first() const
  {
    return empty() ? Handle<T>() : (*begin()).handle;
  }

 private:
  friend class Scene;

  static constexpr std::size_t aspect_count = std::size_t(Aspect::Count);
  struct Slot {
    T value;
    /** The generation of the thing, or of the last one if it was removed. */
    std::uint32_t generation = 1;
    /** The largest generation that this slot has had. */
    std::uint32_t last_generation = 1;
    bool is_live = true;
    std::array<Revision, aspect_count> revisions{};
  };

  /** Whether no further thing can use the slot. */
  static bool is_exhausted(const Slot &slot)
  {
    return slot.last_generation == std::numeric_limits<std::uint32_t>::max();
  }
  const Slot &slot(Handle<T> handle) const
  {
    if (!is_live(handle)) {
      throw StaleHandle(handle ? fmt::format("the {} of handle {}.{} was removed, or is another scene's", T::kind_name,
                                             handle.index, handle.generation)
                               : fmt::format("a handle names no {}", T::kind_name));
    }
    return slots_[handle.index];
  }

  Handle<T> add(T value, Revision revision)
  {
    if (removed_.empty() || is_exhausted(slots_[removed_.back()])) {
      slots_.push_back({std::move(value)});
      const Handle<T> handle{std::uint32_t(slots_.size() - 1), 1};
      touch(handle, revision);
      return handle;
    }
    const std::uint32_t index = removed_.back();
    removed_.pop_back();
    const Handle<T> handle{index, ++slots_[index].last_generation};
    fill(handle, std::move(value), revision);
    return handle;
  }
  /** \pre is_restorable(handle) */
  void restore(Handle<T> handle, T value, Revision revision)
  {
    // Search from the end: undo restores the last removed thing.
    removed_.erase(std::prev(std::find(removed_.rbegin(), removed_.rend(), handle.index).base()));
    fill(handle, std::move(value), revision);
  }
  void remove(Handle<T> handle, Revision revision)
  {
    Slot &removed = slots_[handle.index];
    // First, because it may throw. Slots whose generations are exhausted stay behind those that can be used again.
    removed_.insert(is_exhausted(removed) ? removed_.begin() : removed_.end(), handle.index);
    removed.value = T();
    removed.is_live = false;
    latest_.fill(revision);
  }
  void fill(Handle<T> handle, T value, Revision revision)
  {
    Slot &slot = slots_[handle.index];
    slot.value = std::move(value);
    slot.generation = handle.generation;
    slot.is_live = true;
    touch(handle, revision);
  }
  /** Changes all aspects. */
  void touch(Handle<T> handle, Revision revision)
  {
    slots_[handle.index].revisions.fill(revision);
    latest_.fill(revision);
  }
  void touch(Handle<T> handle, Aspect aspect, Revision revision)
  {
    slots_[handle.index].revisions[std::size_t(aspect)] = revision;
    latest_[std::size_t(aspect)] = revision;
  }
  T &writable(Handle<T> handle)
  {
    slot(handle);
    return slots_[handle.index].value;
  }

  std::deque<Slot> slots_;
  /** The indices of the slots without a thing; those of the last removals are last. */
  std::vector<std::uint32_t> removed_;
  std::array<Revision, aspect_count> latest_{};
  FirstRevision first_revision_;
};

}  // namespace gnomon::scene
