// SPDX-License-Identifier: MIT
#include "scene_animation.hh"

#include "internal/scene_rest_shape.hh"
#include "scene.hh"

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
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

/** Adds the differences of the morph targets at \a weights. */
void morph(const DeformedMesh &deformed, std::span<const double> weights, Shape &shape)
{
  const auto add = [](std::vector<glm::dvec3> &sum, const std::vector<glm::vec3> &differences, double weight) {
    for (std::size_t i = 0; i < std::min(sum.size(), differences.size()); i++) {
      sum[i] += weight * glm::dvec3(differences[i]);
    }
  };
  for (std::size_t i = 0; i < std::min(deformed.targets.size(), weights.size()); i++) {
    if (weights[i] != 0.0) {
      add(shape.positions, deformed.targets[i].positions, weights[i]);
      add(shape.normals, deformed.targets[i].normals, weights[i]);
      add(shape.tangents, deformed.targets[i].tangents, weights[i]);
    }
  }
}

/** The reason why \a mesh cannot be deformed; empty if it can. */
std::string fault_of(const Scene &scene, const DeformedMesh &deformed, const Mesh &mesh)
{
  const std::size_t count = deformed.positions.size();
  if (mesh.positions.size() != count) {
    return fmt::format("it has {} positions, and its rest shape in Scene::deformed_meshes has {}",
                       mesh.positions.size(), count);
  }
  if (deformed.normals.size() != count || (!deformed.tangents.empty() && deformed.tangents.size() != count)) {
    return fmt::format("its rest shape has {} positions, {} normals and {} tangents", count, deformed.normals.size(),
                       deformed.tangents.size());
  }
  if (deformed.weights.size() != deformed.targets.size()) {
    return fmt::format("it has {} morph targets and {} weights", deformed.targets.size(), deformed.weights.size());
  }
  if (deformed.skin < 0) {
    return {};
  }
  if (std::size_t(deformed.skin) >= scene.skins.size()) {
    return fmt::format("skin {} is beyond the {} of the scene", deformed.skin, scene.skins.size());
  }
  const Skin &skin = scene.skins[std::size_t(deformed.skin)];
  if (skin.joints.size() != skin.joint_from_mesh.size()) {
    return fmt::format("skin '{}' has {} joints and {} matrices", skin.name, skin.joints.size(),
                       skin.joint_from_mesh.size());
  }
  if (deformed.joint_weights.size() != count * deformed.joint_sets) {
    return fmt::format("its rest shape has {} positions and {} joint weights, which is not {} for each", count,
                       deformed.joint_weights.size(), deformed.joint_sets);
  }
  return {};
}

/** The mesh that a deformation writes; nullptr if \a deformed takes no part in it. */
const Mesh *mesh_of(const Scene &scene, const DeformedMesh &deformed)
{
  const Mesh *mesh = scene.meshes().find(deformed.mesh);
  return mesh && !mesh->host_shape && scene.nodes().is_live(deformed.node) ? mesh : nullptr;
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

/** The weighted sum of the matrices of a vertex. \throws InvalidEdit that names \a mesh if it has no such joint */
glm::dmat4 vertex_matrix(const DeformedMesh &deformed, const std::vector<glm::dmat4> &joints, std::size_t vertex,
                         const Mesh &mesh)
{
  glm::dmat4 matrix(0.0);
  for (std::size_t set = 0; set < deformed.joint_sets; set++) {
    const JointWeights &influence = deformed.joint_weights[vertex * deformed.joint_sets + set];
    for (int i = 0; i < 4; i++) {
      if (influence.weights[i] != 0.0F) {
        const std::size_t joint = influence.joints[std::size_t(i)];
        if (joint >= joints.size()) {
          throw InvalidEdit(fmt::format("mesh '{}': vertex {} has joint {}, and its skin has {}", mesh.name, vertex,
                                        joint, joints.size()));
        }
        matrix += double(influence.weights[i]) * joints[joint];
      }
    }
  }
  return matrix;
}

void skin_vertices(const DeformedMesh &deformed, const std::vector<glm::dmat4> &joints, const Mesh &mesh, Shape &shape)
{
  for (std::size_t vertex = 0; vertex < shape.positions.size(); vertex++) {
    const glm::dmat4 matrix = vertex_matrix(deformed, joints, vertex, mesh);
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

/** The outcome of one deformation. */
struct Deformed {
  /** Empty: the mesh does not change. */
  std::optional<PosedVertices> vertices;
  /** \see DeformedMesh::reversed_triangles */
  std::vector<bool> reversed_triangles;
};

/** \a current with its vertices deformed by \a joints. */
Deformed deformed_mesh(const DeformedMesh &deformed, const std::vector<glm::dmat4> &joints, const Mesh &current)
{
  Shape shape{.positions = {deformed.positions.begin(), deformed.positions.end()},
              .normals = {deformed.normals.begin(), deformed.normals.end()},
              .tangents = {deformed.tangents.begin(), deformed.tangents.end()}};
  morph(deformed, deformed.weights, shape);
  if (deformed.skin >= 0) {
    skin_vertices(deformed, joints, current, shape);
  }
  Deformed result{.vertices = {}, .reversed_triangles = mirrored_triangles(shape, current)};
  PosedVertices posed;
  if (result.reversed_triangles != deformed.reversed_triangles) {
    posed.indices = rest_indices(current, deformed);
    reverse(result.reversed_triangles, *posed.indices);
  }
  if (deformed.has_flat_normals) {
    make_flat_normals(shape, posed.indices ? *posed.indices : current.indices);
  }
  for (std::size_t i = 0; i < shape.positions.size(); i++) {
    posed.positions.emplace_back(shape.positions[i]);
    posed.normals.push_back(unit_or(shape.normals[i], deformed.normals[i]));
    if (!shape.tangents.empty()) {
      const bool is_mirrored = !shape.is_mirrored.empty() && shape.is_mirrored[i];
      posed.tangents.emplace_back(unit_or(shape.tangents[i], glm::vec3(deformed.tangents[i])),
                                  (is_mirrored ? -1.0F : 1.0F) * deformed.tangents[i].w);
    }
  }
  // Do not edit the mesh if it does not change, so that it is not uploaded and shadows are not drawn again.
  if (posed.indices || posed.positions != current.positions || posed.normals != current.normals ||
      posed.tangents != current.tangents) {
    result.vertices = std::move(posed);
  }
  return result;
}

/** A vector whose sum with \a difference has the direction of \a sum; of length 1 if there is one. */
glm::dvec3 without_difference(const glm::dvec3 &sum, const glm::dvec3 &difference)
{
  const double along = glm::dot(sum, difference);
  const double square = along * along - glm::dot(difference, difference) + 1.0;
  return (along + std::sqrt(std::max(0.0, square))) * sum - difference;
}

/** Whether the normals of \a mesh are those of its triangles. */
bool has_flat_normals(const Mesh &mesh)
{
  Shape flat{{mesh.positions.begin(), mesh.positions.end()}, {mesh.normals.begin(), mesh.normals.end()}, {}};
  make_flat_normals(flat, mesh.indices);
  constexpr float tolerance = 1e-5F;
  for (std::size_t i = 0; i < mesh.normals.size(); i++) {
    if (glm::distance(unit_or(flat.normals[i], mesh.normals[i]), mesh.normals[i]) > tolerance) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::optional<RestShape> edited_rest_shape(const Scene &scene, const DeformedMesh &deformed, const Mesh &before,
                                           const Mesh &after)
{
  if (after.host_shape || !fault_of(scene, deformed, after).empty()) {
    return std::nullopt;
  }
  // An edit that did not fit has changed all vertices.
  const std::size_t count = deformed.positions.size();
  const auto is_same = [&](const auto &a, const auto &b, std::size_t i) { return a.size() == count && a[i] == b[i]; };
  RestShape rest{deformed.positions, deformed.normals, deformed.tangents,
                 deformed.has_flat_normals && has_flat_normals(after)};
  const bool were_flat = deformed.has_flat_normals && !rest.has_flat_normals;
  rest.tangents.resize(after.tangents.size());
  // The differences of the morph targets alone.
  Shape morphs{std::vector<glm::dvec3>(count), std::vector<glm::dvec3>(count),
               std::vector<glm::dvec3>(rest.tangents.size())};
  morph(deformed, deformed.deformed_by_weights, morphs);
  for (std::size_t i = 0; i < count; i++) {
    const bool is_moved = !is_same(before.positions, after.positions, i);
    const bool is_turned = were_flat || !is_same(before.normals, after.normals, i);
    const bool has_new_tangent =
        i < rest.tangents.size() && (deformed.tangents.empty() || !is_same(before.tangents, after.tangents, i));
    if (!is_moved && !is_turned && !has_new_tangent) {
      continue;
    }
    const glm::dmat4 matrix = deformed.deformed_by_joints.empty()
                                  ? glm::dmat4(1.0)
                                  : vertex_matrix(deformed, deformed.deformed_by_joints, i, after);
    const glm::dmat3 inverse = glm::inverse(glm::dmat3(matrix));
    if (is_moved) {
      rest.positions[i] = inverse * (glm::dvec3(after.positions[i]) - glm::dvec3(matrix[3])) - morphs.positions[i];
      // The negated condition also refuses NaN.
      if (!(glm::length(glm::dvec3(rest.positions[i])) <= double(std::numeric_limits<float>::max()))) {
        throw InvalidEdit(
            fmt::format("mesh '{}': vertex {} cannot be edited, because its joints flatten it", after.name, i));
      }
    }
    if (is_turned) {
      // The inverse of the cofactor matrix, which transforms normals, without its factor.
      const glm::vec3 normal =
          unit_or(glm::transpose(glm::dmat3(matrix)) * glm::dvec3(after.normals[i]), after.normals[i]);
      rest.normals[i] = unit_or(without_difference(normal, morphs.normals[i]), normal);
    }
    if (has_new_tangent) {
      const glm::vec3 direction(after.tangents[i]);
      const glm::vec3 tangent = unit_or(inverse * glm::dvec3(direction), direction);
      rest.tangents[i] = {unit_or(without_difference(tangent, morphs.tangents[i]), tangent),
                          (glm::determinant(matrix) < 0.0 ? -1.0F : 1.0F) * after.tangents[i].w};
    }
  }
  return rest;
}

std::string fault_of(const Scene &scene, const DeformedMesh &deformed)
{
  const Mesh *mesh = mesh_of(scene, deformed);
  return mesh ? fault_of(scene, deformed, *mesh) : std::string();
}

void check_deformed_meshes(const Scene &scene)
{
  for (const DeformedMesh &deformed : scene.deformed_meshes) {
    if (const std::string fault = fault_of(scene, deformed); !fault.empty()) {
      throw InvalidEdit(fmt::format("mesh '{}': it cannot be deformed: {}", scene.meshes()[deformed.mesh].name, fault));
    }
  }
}

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
  check_deformed_meshes(scene);
  for (DeformedMesh &deformed : scene.deformed_meshes) {
    const Mesh *mesh = mesh_of(scene, deformed);
    if (!mesh) {
      continue;
    }
    std::vector<glm::dmat4> joints;
    if (deformed.skin >= 0) {
      joints = joint_matrices(scene, scene.skins[std::size_t(deformed.skin)], deformed.node);
    }
    if (joints == deformed.deformed_by_joints && deformed.weights == deformed.deformed_by_weights) {
      continue;
    }
    Deformed changed = deformed_mesh(deformed, joints, *mesh);
    if (changed.vertices) {
      scene.set_posed(deformed.mesh, std::move(*changed.vertices));
    }
    deformed.reversed_triangles = std::move(changed.reversed_triangles);
    deformed.deformed_by_joints = std::move(joints);
    deformed.deformed_by_weights = deformed.weights;
  }
}

}  // namespace gnomon::scene
