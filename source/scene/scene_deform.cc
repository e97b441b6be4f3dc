// SPDX-License-Identifier: MIT
#include "scene_animation.hh"

#include "scene.hh"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace gnomon::scene {

namespace {

/** The unit vector in the direction of \a vector; \a fallback if the length of \a vector is 0 or not finite. */
glm::vec3 unit_or(const glm::dvec3 &vector, const glm::vec3 &fallback)
{
  const double length = glm::length(vector);
  return length > 0.0 && std::isfinite(length) ? glm::vec3(vector / length) : fallback;
}

/** The vertices of one mesh during the deformation. */
struct Shape {
  std::vector<glm::dvec3> positions;
  std::vector<glm::dvec3> normals;
  std::vector<glm::dvec3> tangents;
  /** Vertices that joints mirror. Empty: none. */
  std::vector<bool> is_mirrored{};
};

Shape morphed(const DeformedMesh &deformed)
{
  Shape shape{.positions = {deformed.positions.begin(), deformed.positions.end()},
              .normals = {deformed.normals.begin(), deformed.normals.end()},
              .tangents = {deformed.tangents.begin(), deformed.tangents.end()}};
  const auto add = [](std::vector<glm::dvec3> &sum, const std::vector<glm::vec3> &differences, double weight) {
    for (std::size_t i = 0; i < std::min(sum.size(), differences.size()); i++) {
      sum[i] += weight * glm::dvec3(differences[i]);
    }
  };
  for (std::size_t i = 0; i < deformed.targets.size(); i++) {
    if (deformed.weights[i] != 0.0) {
      add(shape.positions, deformed.targets[i].positions, deformed.weights[i]);
      add(shape.normals, deformed.targets[i].normals, deformed.weights[i]);
      add(shape.tangents, deformed.targets[i].tangents, deformed.weights[i]);
    }
  }
  return shape;
}

/**
 * For each joint, the matrix from the rest shape of the mesh to the node's space. A removed joint has the identity
 * matrix, so it does not deform the mesh.
 */
std::vector<glm::dmat4> joint_matrices(const Scene &scene, const Skin &skin, Handle<Node> node)
{
  const glm::dmat4 &world_from_node = scene.world_from_node(node);
  // glTF ignores the transform of a skinned node, so multiply by its inverse. A singular transform has no inverse and
  // is not cancelled.
  const bool is_singular = !(std::abs(glm::determinant(world_from_node)) > 0.0);
  const glm::dmat4 node_from_world = is_singular ? glm::dmat4(1.0) : glm::inverse(world_from_node);
  std::vector<glm::dmat4> matrices;
  for (std::size_t i = 0; i < skin.joints.size(); i++) {
    matrices.push_back(scene.nodes().is_live(skin.joints[i])
                           ? node_from_world * scene.world_from_node(skin.joints[i]) * skin.joint_from_mesh[i]
                           : glm::dmat4(1.0));
  }
  return matrices;
}

/** The cofactor matrix, which transforms normals. It needs no division, so it exists for singular matrices, too. */
glm::dmat3 normal_matrix(const glm::dmat3 &m)
{
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

void skin_vertices(const DeformedMesh &deformed, const std::vector<glm::dmat4> &joints, Shape &shape)
{
  for (std::size_t vertex = 0; vertex < shape.positions.size(); vertex++) {
    glm::dmat4 matrix(0.0);
    for (std::size_t set = 0; set < deformed.joint_sets; set++) {
      const JointWeights &influence = deformed.joint_weights[vertex * deformed.joint_sets + set];
      for (int i = 0; i < 4; i++) {
        if (influence.weights[i] != 0.0F) {
          matrix += double(influence.weights[i]) * joints[influence.joints[std::size_t(i)]];
        }
      }
    }
    shape.positions[vertex] = glm::dvec3(matrix * glm::dvec4(shape.positions[vertex], 1.0));
    const glm::dmat3 linear(matrix);
    const bool is_mirrored = glm::determinant(linear) < 0.0;
    if (is_mirrored && shape.is_mirrored.empty()) {
      shape.is_mirrored.resize(shape.positions.size(), false);
    }
    if (is_mirrored) {
      shape.is_mirrored[vertex] = true;
    }
    // The cofactors of a mirroring matrix reverse normals. Reverse them again.
    shape.normals[vertex] = (is_mirrored ? -1.0 : 1.0) * (normal_matrix(linear) * shape.normals[vertex]);
    if (!shape.tangents.empty()) {
      shape.tangents[vertex] = linear * shape.tangents[vertex];
    }
  }
}

/** The triangles of which joints mirror at least two corners. Empty: none. */
std::vector<bool> mirrored_triangles(const Shape &shape, const Mesh &mesh)
{
  std::vector<bool> result;
  if (shape.is_mirrored.empty() || mesh.topology != Topology::Triangles) {
    return result;
  }
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const auto is_mirrored = [&](std::size_t corner) { return shape.is_mirrored[mesh.indices[i + corner]] ? 1 : 0; };
    result.push_back(is_mirrored(0) + is_mirrored(1) + is_mirrored(2) >= 2);
  }
  return result;
}

/** Swaps two indices of each triangle of \a reversed, which may be shorter. */
void reverse(const std::vector<bool> &reversed, std::vector<std::uint32_t> &indices)
{
  for (std::size_t i = 0; i < std::min(reversed.size(), indices.size() / 3); i++) {
    if (reversed[i]) {
      std::swap(indices[3 * i + 1], indices[3 * i + 2]);
    }
  }
}

void make_flat_normals(Shape &shape, const std::vector<std::uint32_t> &indices)
{
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const glm::dvec3 &a = shape.positions[indices[i]];
    const glm::dvec3 normal = glm::cross(shape.positions[indices[i + 1]] - a, shape.positions[indices[i + 2]] - a);
    for (std::size_t corner = 0; corner < 3; corner++) {
      shape.normals[indices[i + corner]] = normal;
    }
  }
}

void deform(Scene &scene, DeformedMesh &deformed)
{
  std::vector<glm::dmat4> joints;
  if (deformed.skin >= 0) {
    joints = joint_matrices(scene, scene.skins[std::size_t(deformed.skin)], deformed.node);
  }
  if (joints == deformed.deformed_by_joints && deformed.weights == deformed.deformed_by_weights) {
    return;
  }
  deformed.deformed_by_joints = std::move(joints);
  deformed.deformed_by_weights = deformed.weights;
  const Mesh &current = scene.meshes()[deformed.mesh];
  Shape shape = morphed(deformed);
  if (deformed.skin >= 0) {
    skin_vertices(deformed, deformed.deformed_by_joints, shape);
  }
  std::vector<bool> reversed = mirrored_triangles(shape, current);
  const bool is_reordered = reversed != deformed.reversed_triangles;
  std::vector<std::uint32_t> reordered;
  if (is_reordered) {
    reordered = rest_indices(current, deformed);
    reverse(reversed, reordered);
    deformed.reversed_triangles = std::move(reversed);
  }
  if (deformed.has_flat_normals) {
    make_flat_normals(shape, is_reordered ? reordered : current.indices);
  }
  std::vector<glm::vec3> positions;
  std::vector<glm::vec3> normals;
  std::vector<glm::vec4> tangents;
  for (std::size_t i = 0; i < shape.positions.size(); i++) {
    positions.emplace_back(shape.positions[i]);
    normals.push_back(unit_or(shape.normals[i], deformed.normals[i]));
    if (!shape.tangents.empty()) {
      const bool is_mirrored = !shape.is_mirrored.empty() && shape.is_mirrored[i];
      tangents.emplace_back(unit_or(shape.tangents[i], glm::vec3(deformed.tangents[i])),
                            (is_mirrored ? -1.0F : 1.0F) * deformed.tangents[i].w);
    }
  }
  // Do not edit the mesh if it does not change, so that it is not uploaded and shadows are not drawn again.
  if (positions == current.positions && normals == current.normals && tangents == current.tangents && !is_reordered) {
    return;
  }
  scene.edit(deformed.mesh, [&](Mesh &mesh) {
    mesh.positions = std::move(positions);
    mesh.normals = std::move(normals);
    mesh.tangents = std::move(tangents);
    if (is_reordered) {
      mesh.indices = std::move(reordered);
    }
  });
}

}  // namespace

void set_morph_weights(Scene &scene, Handle<Node> node, std::span<const double> weights)
{
  for (DeformedMesh &deformed : scene.deformed_meshes) {
    if (deformed.node == node) {
      for (std::size_t i = 0; i < deformed.weights.size(); i++) {
        deformed.weights[i] = i < weights.size() ? weights[i] : 0.0;
      }
    }
  }
}

std::vector<std::uint32_t> rest_indices(const Mesh &mesh, const DeformedMesh &deformed)
{
  std::vector<std::uint32_t> indices = mesh.indices;
  reverse(deformed.reversed_triangles, indices);
  return indices;
}

void deform_meshes(Scene &scene)
{
  for (DeformedMesh &deformed : scene.deformed_meshes) {
    const Mesh *mesh = scene.meshes().find(deformed.mesh);
    if (mesh && !mesh->host_shape && scene.nodes().is_live(deformed.node)) {
      deform(scene, deformed);
    }
  }
}

}  // namespace gnomon::scene
