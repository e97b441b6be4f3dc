// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

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
 * handle is detected and never refers to another thing. Plain data: it can be copied, compared and used as a key.
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

/** Number of an edit of a scene. A later edit has a larger revision; 0 precedes the first edit. */
using Revision = std::uint64_t;

}  // namespace gnomon::scene

template <typename T>
struct std::hash<gnomon::scene::Handle<T>> {
  std::size_t operator()(const gnomon::scene::Handle<T> &handle) const
  {
    return std::hash<std::uint64_t>()(handle.key());
  }
};
