// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <cstdint>
#include <span>
#include <string>

/** Import of morph targets and skins. Internal to source/gltf. */
namespace gnomon::gltf {

/** Whether the node's mesh has morph targets. \pre the node has a mesh */
[[nodiscard]] bool has_targets(const Model &model, const Model::Node &node);

/** Maximum number of joints of a skin. glTF has no limit, but JOINTS_n has at most 16 bits. */
inline constexpr std::size_t joint_count_max = 65536;

/**
 * Read morph targets, joints and weights of \a mesh. \a file_vertices: for each vertex of \a mesh, its index in the
 * attributes of \a primitive. \a skin: index of the skin in the file, or -1. Omits data that cannot be read, with a
 * warning that names \a what.
 * \return the rest shape. The caller sets its members mesh, node and has_flat_normals.
 */
[[nodiscard]] scene::DeformedMesh read_deformed(const File &file, const Model::Primitive &primitive, int skin,
                                                const scene::Mesh &mesh, std::span<const std::uint32_t> file_vertices,
                                                const std::string &what, Warnings &warnings);

/** Upper bound of the number of vectors that read_deformed reads for each vertex. */
[[nodiscard]] std::uint64_t deformed_width(const Model::Primitive &primitive, bool has_skin);

/** Append the file's skins to \a scene. \a nodes: the imported nodes by their indices in the file, or invalid. */
void import_skins(const File &file, const std::vector<scene::Handle<scene::Node>> &nodes, Warnings &warnings,
                  scene::Scene &scene);

}  // namespace gnomon::gltf
