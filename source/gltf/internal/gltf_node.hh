// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_model.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <glm/mat4x4.hpp>

#include <functional>
#include <string>
#include <string_view>

/** Reads properties of nodes except their lamps. Internal to source/gltf. */
namespace gnomon::gltf {

/** Whether an extra applies to all nodes, not only to those with a lamp. */
[[nodiscard]] bool is_node_extra(std::string_view key);

/** The extras gnomon_visible, gnomon_casts_shadow and gnomon_receives_shadow. \throws Fault that names \a node. */
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
