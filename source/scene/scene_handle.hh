// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <compare>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string_view>

namespace gnomon::scene {

/**
 * Identifies one thing of a scene: a node, mesh, material, lamp, … \a T is the thing's type.
 *
 * A handle stays valid until its thing is removed. Its index may then be reused with another generation, so that an old
 * handle is detected and never refers to another thing. Scene::restore makes it valid again. Plain data: it can be
 * copied, compared and used as a key.
 */
template <typename T>
struct Handle {
  std::uint32_t index = 0;
  /** 0 for an invalid handle. */
  std::uint32_t generation = 0;

  explicit operator bool() const
  {
    return generation != 0;
  }
  auto operator<=>(const Handle &) const = default;

  /** Unique among all things of a type that a scene ever held; 0 for an invalid handle. */
  [[nodiscard]] std::uint64_t key() const
  {
    return std::uint64_t(generation) << 32U | index;
  }
};

/** Thrown for the use of an invalid or stale handle. The message names the type of the thing. */
struct StaleHandle : std::logic_error {
  using std::logic_error::logic_error;
};

/**
 * Number of an edit of a scene. A later edit of any scene of the process has a larger revision, so that no two edits
 * have the same one; 0 precedes all edits.
 */
using Revision = std::uint64_t;

/** A larger number with each call. Thread-safe. */
[[nodiscard]] Revision next_revision();

/**
 * A lower bound of all revisions of the object that has this member: the revision of its construction or of its last
 * assignment. Copies and moves are constructions, and change the object that was moved from, too. A consumer of the
 * object then sees that everything in it has changed, whatever the object held before.
 */
class FirstRevision {
 public:
  FirstRevision() = default;
  ~FirstRevision() = default;
  FirstRevision(const FirstRevision & /*other*/) : FirstRevision() {}
  FirstRevision(FirstRevision &&other) noexcept
  {
    other.value_ = value_;
  }
  FirstRevision &operator=(const FirstRevision & /*other*/)
  {
    value_ = next_revision();
    return *this;
  }
  FirstRevision &operator=(FirstRevision &&other) noexcept
  {
    value_ = other.value_ = next_revision();
    return *this;
  }
  /** \a revision, or the first revision if that is later. */
  [[nodiscard]] Revision or_later(Revision revision) const
  {
    return std::max(revision, value_);
  }

 private:
  Revision value_ = next_revision();
};

}  // namespace gnomon::scene

template <typename T>
struct std::hash<gnomon::scene::Handle<T>> {
  std::size_t operator()(const gnomon::scene::Handle<T> &handle) const
  {
    return std::hash<std::uint64_t>()(handle.key());
  }
};
