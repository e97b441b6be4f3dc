// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_model.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <glm/mat4x4.hpp>

#include <functional>
#include <string>
#include <string_view>
#include <type_traits>

/** Reads properties of nodes except their lamps. Internal to source/gltf. */
namespace gnomon::gltf {

/** Whether an extra applies to all nodes, not only to those with a lamp. */
[[nodiscard]] bool is_node_extra(std::string_view key);

/** Calls \a visit with each row of a node that is an extra: true or false. */
template <typename Visit>
void for_each_flag(Visit &&visit)
{
  scene::Node::for_each_property([&](const auto &row) {
    if constexpr (std::is_same_v<typename std::decay_t<decltype(row)>::Value, bool>) {
      if (row.extra_kinds != 0) {
        visit(row);
      }
    }
  });
}

/** The extras of for_each_flag. \throws Fault that names \a node. */
void read_flags(const Model::Node &source, int index, scene::Node &node);

/** Whether a quaternion can be normalised. */
[[nodiscard]] bool is_rotation(const glm::dvec4 &xyzw);
/** Translation · rotation · scale; without the rotation where is_rotation is false. */
[[nodiscard]] glm::dmat4 matrix_from(const glm::dvec3 &translation, const glm::dvec4 &rotation_xyzw,
                                     const glm::dvec3 &scale);

/**
 * The matrix of a node, or of its translation, rotation and scale, with a warning about what is not used of them. \a
 * what: called for the name of the node if there is a warning.
 */
[[nodiscard]] glm::dmat4 matrix_of(const Model::Node &node, const std::function<std::string()> &what,
                                   Warnings &warnings);

/**
 * The name of a lamp or camera on a node: the first of the extra \a key, the node's name, \a fallback, and a text made
 * of \a kind and \a index.
 */
[[nodiscard]] std::string thing_name(const Model::Node &node, const char *key, const std::string &fallback,
                                     const char *kind, int index);

}  // namespace gnomon::gltf
