// SPDX-License-Identifier: MIT
#pragma once

#include "scene_handle.hh"

#include <array>
#include <deque>
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
  [[nodiscard]] std::size_t size() const
  {
    return size_;
  }
  [[nodiscard]] bool empty() const
  {
    return size_ == 0;
  }
  /** Above all values of Handle::index in the pool: the size of an array indexed by them. */
  [[nodiscard]] std::size_t index_end() const
  {
    return slots_.size();
  }

  /** Last change of an aspect of one thing; adding the thing changes all its aspects. \throws StaleHandle */
  [[nodiscard]] Revision revision(Handle<T> handle, Aspect aspect) const
  {
    return slot(handle).revisions[std::size_t(aspect)];
  }
  /** Last change of the aspect of any thing; adding and removing a thing changes all aspects. */
  [[nodiscard]] Revision latest(Aspect aspect) const
  {
    return latest_[std::size_t(aspect)];
  }
  /** Last change of any aspect of any thing. */
  [[nodiscard]] Revision latest() const
  {
    Revision revision = 0;
    for (const Revision each : latest_) {
      revision = std::max(revision, each);
    }
    return revision;
  }

  struct Item {
    Handle<T> handle;
    const T &value;
  };
  class Iterator {
   public:
    Iterator(const Pool &pool, std::size_t index) : pool_(&pool), index_(index)
    {
      skip_removed();
    }
    Item operator*() const
    {
      const Slot &slot = pool_->slots_[index_];
      return {{std::uint32_t(index_), slot.generation}, slot.value};
    }
    Iterator &operator++()
    {
      index_++;
      skip_removed();
      return *this;
    }
    bool operator==(const Iterator &) const = default;

   private:
    void skip_removed()
    {
      while (index_ < pool_->slots_.size() && !pool_->slots_[index_].is_live) {
        index_++;
      }
    }
    const Pool *pool_;
    std::size_t index_;
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
    std::uint32_t generation = 1;
    bool is_live = true;
    std::array<Revision, aspect_count> revisions{};
  };

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
    std::uint32_t index = std::uint32_t(slots_.size());
    if (free_.empty()) {
      slots_.push_back({std::move(value)});
    }
    else {
      index = free_.back();
      slots_[index].value = std::move(value);
      slots_[index].is_live = true;
      free_.pop_back();
    }
    slots_[index].revisions.fill(revision);
    latest_.fill(revision);
    size_++;
    return {index, slots_[index].generation};
  }
  void remove(Handle<T> handle, Revision revision)
  {
    // First, because it may throw.
    free_.push_back(handle.index);
    Slot &removed = slots_[handle.index];
    removed.value = T();
    removed.is_live = false;
    removed.generation++;
    latest_.fill(revision);
    size_--;
    // The slot is not reused once its generations are exhausted.
    if (removed.generation == 0) {
      free_.pop_back();
    }
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
  std::vector<std::uint32_t> free_;
  std::array<Revision, aspect_count> latest_{};
  std::size_t size_ = 0;
};

}  // namespace gnomon::scene
