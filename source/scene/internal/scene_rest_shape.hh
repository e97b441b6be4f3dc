// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <optional>
#include <vector>

/** Edits of deformed meshes. */
namespace gnomon::scene {

/** The members of a DeformedMesh that an edit of its mesh changes. */
struct RestShape {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec4> tangents;
  bool has_flat_normals = false;
};

/** The streams of a mesh that a pose changes: as many values as the mesh has positions. */
struct PosedVertices {
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  /** Empty: the mesh gets none. */
  std::vector<glm::vec4> tangents;
  /** The indices of the mesh with other triangles reversed. Empty: the mesh keeps its own. */
  std::optional<std::vector<std::uint32_t>> indices;
};

/**
 * The rest shape that the last deformation of \a deformed would deform to \a after. \a before: the mesh of the scene.
 * Vertices that are the same in both keep their rest shape. Empty if \a after does not fit the rest shape, or is a
 * shape in buffers of a host. \throws InvalidEdit if there is none, because the joints flatten a vertex that differs
 */
[[nodiscard]] std::optional<RestShape> edited_rest_shape(const Scene &scene, const DeformedMesh &deformed,
                                                         const Mesh &before, const Mesh &after);

/** \throws InvalidEdit that names the mesh if one of Scene::deformed_meshes has a fault. */
void check_deformed_meshes(const Scene &scene);

}  // namespace gnomon::scene
