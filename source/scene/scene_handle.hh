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
 * Names one thing of a scene: a node, mesh, material, lamp, … \a T is the thing's type.
 *
 * A handle stays valid until its thing is removed. Its place may then be used again, with another generation, so that
 * an old handle is detected and never names another thing. Plain data: copy it, compare it, use it as a key.
 */
template <typename T>
struct Handle {
  std::uint32_t index = 0;
  /** 0: the handle names nothing. */
  std::uint32_t generation = 0;

  explicit operator bool() const
  {
    return generation != 0;
  }
  auto operator<=>(const Handle &) const = default;

  /** Different for each thing of a kind that a scene ever held; 0 for nothing. */
  [[nodiscard]] std::uint64_t key() const
  {
    return std::uint64_t(generation) << 32U | index;
  }
};

/** A handle that names nothing, or a thing that was removed, was used. The message names the kind of thing. */
struct StaleHandle : std::logic_error {
  using std::logic_error::logic_error;
};

/** Counts the edits of a scene. A larger revision is a later edit; 0 is before the first. */
using Revision = std::uint64_t;

}  // namespace gnomon::scene

template <typename T>
struct std::hash<gnomon::scene::Handle<T>> {
  std::size_t operator()(const gnomon::scene::Handle<T> &handle) const
  {
    return std::hash<std::uint64_t>()(handle.key());
  }
};
