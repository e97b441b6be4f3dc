// SPDX-License-Identifier: MIT
#pragma once

#include "scene_types.hh"

#include <cstdint>
#include <cstring>

/** The comparisons by which an edit finds the aspects that it changes. */
namespace gnomon::scene {

/** Compares bit patterns, so that a NaN equals itself and an unchanged thing gets no new revision. */
template <typename T>
bool same_bytes(const T &a, const T &b)
{
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

/** Bits of the aspects that differ: bit i for the aspect of value i. */
using Changes = std::uint32_t;

/** The aspects in which \a a and \a b differ. */
[[nodiscard]] Changes changes(const Mesh &a, const Mesh &b);
[[nodiscard]] Changes changes(const Image &a, const Image &b);
[[nodiscard]] Changes changes(const Texture &a, const Texture &b);
[[nodiscard]] Changes changes(const SurfaceFunction &a, const SurfaceFunction &b);
[[nodiscard]] Changes changes(const Material &a, const Material &b);
[[nodiscard]] Changes changes(const Lamp &a, const Lamp &b);
[[nodiscard]] Changes changes(const Camera &a, const Camera &b);
/** Without Transform and Visibility, which also depend on the ancestors. \see Scene::update_subtree */
[[nodiscard]] Changes changes(const Node &a, const Node &b);

}  // namespace gnomon::scene
