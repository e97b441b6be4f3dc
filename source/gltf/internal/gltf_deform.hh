// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <cstdint>
#include <map>
#include <span>
#include <string>

/** Morph targets and skins. Internal to source/gltf. */
namespace gnomon::gltf {

/** Whether the node's mesh has morph targets, or the node a skin. Such a mesh belongs to one node. */
[[nodiscard]] bool is_deformed(const Model &model, const Model::Node &node);

/** Largest number of joints of a skin; glTF sets no limit, and JOINTS_n has 16 bits. */
inline constexpr std::size_t joint_count_max = 65536;

/**
 * Reads morph targets, joints and weights for \a mesh, whose vertices are \a file_vertices of \a primitive. What cannot
 * be read is left out with a warning about \a what. \return the rest shape; its mesh, node and has_flat_normals are not
 * set.
 */
[[nodiscard]] scene::DeformedMesh read_deformed(const File &file, const Model::Primitive &primitive, int skin,
                                                const scene::Mesh &mesh, std::span<const std::uint32_t> file_vertices,
                                                const std::string &what, Warnings &warnings);

/** The number of values that read_deformed reads for each vertex. */
[[nodiscard]] std::uint64_t deformed_width(const Model::Primitive &primitive, bool has_skin);

/** Appends the file's skins to \a scene. \a nodes: the scene's node for each node of the file that was imported. */
void import_skins(const File &file, const std::map<int, scene::Handle<scene::Node>> &nodes, Warnings &warnings,
                  scene::Scene &scene);

}  // namespace gnomon::gltf
