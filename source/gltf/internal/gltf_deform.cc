// SPDX-License-Identifier: MIT
#include "internal/gltf_deform.hh"

#include "internal/gltf_accessor.hh"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace gnomon::gltf {

using scene::DeformedMesh;
using scene::JointWeights;

namespace {

using Attributes = std::map<std::string, int, std::less<>>;

bool is_finite(const glm::vec3 &v)
{
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/** Read an attribute of a morph target. Returns an empty vector if the target does not have it. */
std::vector<glm::vec3> read_differences(const File &file, const Attributes &target, const char *name,
                                        std::span<const std::uint32_t> vertices, std::size_t vertex_count)
{
  const auto found = target.find(name);
  if (found == target.end()) {
    return {};
  }
  const AccessorReader reader(file, found->second, Model::ElementType::Vec3);
  if (reader.count() != vertex_count) {
    throw Fault(name, "count differs from that of POSITION");
  }
  std::vector<glm::vec3> differences;
  for (const std::uint32_t vertex : vertices) {
    differences.push_back(reader.vec3(vertex));
    if (!is_finite(differences.back())) {
      throw Fault(name, "a difference is not finite");
    }
  }
  return differences;
}

void read_targets(const File &file, const Model::Primitive &primitive, std::span<const std::uint32_t> vertices,
                  std::size_t vertex_count, const std::string &what, Warnings &warnings, DeformedMesh &deformed)
{
  for (const Attributes &target : primitive.targets) {
    // Keep an empty entry for a target that cannot be read, so that the indices of the weights stay valid.
    scene::MorphTarget &read = deformed.targets.emplace_back();
    try {
      read = {read_differences(file, target, "POSITION", vertices, vertex_count),
              read_differences(file, target, "NORMAL", vertices, vertex_count),
              deformed.tangents.empty() ? std::vector<glm::vec3>()
                                        : read_differences(file, target, "TANGENT", vertices, vertex_count)};
    }
    catch (const Fault &fault) {
      read = {};
      warnings.add_counted(what, 1, std::string("morph target left out: ") + fault.what());
    }
    for (const auto &[name, accessor] : target) {
      if (name != "POSITION" && name != "NORMAL" && name != "TANGENT") {
        warnings.add_counted(what, 1, "morph target's " + name + " is not read");
      }
    }
  }
  deformed.weights.assign(deformed.targets.size(), 0.0);
}

/** One set of joints and weights. */
struct JointSet {
  AccessorReader joints;
  AccessorReader weights;
};

std::vector<JointSet> open_sets(const File &file, const Model::Primitive &primitive, std::size_t vertex_count)
{
  std::vector<JointSet> sets;
  for (int n = 0;; n++) {
    const auto joints = primitive.attributes.find("JOINTS_" + std::to_string(n));
    const auto weights = primitive.attributes.find("WEIGHTS_" + std::to_string(n));
    if (joints == primitive.attributes.end() || weights == primitive.attributes.end()) {
      break;
    }
    sets.push_back({AccessorReader(file, joints->second, Model::ElementType::Vec4),
                    AccessorReader(file, weights->second, Model::ElementType::Vec4)});
    if (!sets.back().joints.is_unsigned()) {
      throw Fault("JOINTS", "are not unsigned integers");
    }
    if (sets.back().joints.count() != vertex_count || sets.back().weights.count() != vertex_count) {
      throw Fault("JOINTS and WEIGHTS", "count differs from that of POSITION");
    }
  }
  if (sets.empty()) {
    throw Fault("JOINTS_0 and WEIGHTS_0", "are missing");
  }
  return sets;
}

void read_joints(const File &file, const Model::Primitive &primitive, int skin, std::span<const std::uint32_t> vertices,
                 std::size_t vertex_count, const std::string &what, Warnings &warnings, DeformedMesh &deformed)
{
  const std::size_t joint_count = file.model.skins[std::size_t(skin)].joints.size();
  std::uint64_t bad_weights = 0;
  try {
    if (joint_count == 0) {
      throw Fault("joints", "the skin has none");
    }
    const std::vector<JointSet> sets = open_sets(file, primitive, vertex_count);
    for (const std::uint32_t vertex : vertices) {
      const std::size_t first = deformed.joint_weights.size();
      double sum = 0.0;
      for (const JointSet &set : sets) {
        JointWeights &read = deformed.joint_weights.emplace_back();
        const std::array<std::uint32_t, 4> joints = set.joints.integers(vertex);
        const glm::vec4 weights = set.weights.vec4(vertex);
        for (int i = 0; i < 4; i++) {
          const std::uint32_t joint = joints[std::size_t(i)];
          // The negated comparison also skips NaN. The index of a joint without a weight is not checked.
          if (!(weights[i] > 0.0F) || !std::isfinite(weights[i])) {
            continue;
          }
          if (joint >= joint_count) {
            throw Fault("JOINTS", "a joint's index is out of range: the skin has " + std::to_string(joint_count));
          }
          read.joints[std::size_t(i)] = std::uint16_t(joint);
          read.weights[i] = weights[i];
          sum += double(weights[i]);
        }
      }
      if (!(sum > 0.0)) {
        // Bind a vertex without weights to the first joint.
        deformed.joint_weights[first].weights.x = 1.0F;
        sum = 1.0;
        bad_weights++;
      }
      for (std::size_t i = first; i < deformed.joint_weights.size(); i++) {
        deformed.joint_weights[i].weights *= float(1.0 / sum);
      }
    }
    deformed.joint_sets = sets.size();
    deformed.skin = skin;
  }
  catch (const Fault &fault) {
    deformed.joint_weights.clear();
    warnings.add(what, std::string("its skin is not applied: ") + fault.what());
  }
  if (bad_weights > 0) {
    warnings.add_counted(what, bad_weights, "vertex bound to the first joint: its weights have no sum");
  }
}

}  // namespace

bool has_targets(const Model &model, const Model::Node &node)
{
  return std::ranges::any_of(model.meshes[std::size_t(node.mesh)].primitives,
                             [](const Model::Primitive &one) { return !one.targets.empty(); });
}

std::uint64_t deformed_width(const Model::Primitive &primitive, bool has_skin)
{
  std::uint64_t width = has_skin ? 2 * primitive.attributes.size() : 0;
  for (const Attributes &target : primitive.targets) {
    width += target.size();
  }
  return width;
}

DeformedMesh read_deformed(const File &file, const Model::Primitive &primitive, int skin, const scene::Mesh &mesh,
                           std::span<const std::uint32_t> file_vertices, const std::string &what, Warnings &warnings)
{
  DeformedMesh deformed;
  deformed.positions = mesh.positions;
  deformed.normals = mesh.normals;
  deformed.tangents = mesh.tangents;
  const std::size_t vertex_count = file.model.accessors[std::size_t(primitive.attributes.at("POSITION"))].count;
  read_targets(file, primitive, file_vertices, vertex_count, what, warnings, deformed);
  if (skin >= 0) {
    read_joints(file, primitive, skin, file_vertices, vertex_count, what, warnings, deformed);
  }
  return deformed;
}

void import_skins(const File &file, const std::vector<scene::Handle<scene::Node>> &nodes, Warnings &warnings,
                  scene::Scene &scene)
{
  for (std::size_t i = 0; i < file.model.skins.size(); i++) {
    const Model::Skin &source = file.model.skins[i];
    const std::string what = label("skin", source.name, i);
    scene::Skin skin{source.name, {}, std::vector<glm::dmat4>(source.joints.size(), glm::dmat4(1.0))};
    if (source.joints.size() > joint_count_max) {
      throw Fault(what, "has more than " + std::to_string(joint_count_max) + " joints");
    }
    for (const int joint : source.joints) {
      skin.joints.push_back(nodes[joint]);
      if (!nodes[joint]) {
        warnings.add_counted(what, 1, "joint does not move: its node is not in the scene");
      }
    }
    try {
      if (source.inverse_bind_matrices >= 0) {
        const AccessorReader reader(file, source.inverse_bind_matrices, Model::ElementType::Matrix4);
        if (reader.count() < source.joints.size()) {
          throw Fault("inverseBindMatrices", "has fewer elements than the skin has joints");
        }
        for (std::size_t joint = 0; joint < source.joints.size(); joint++) {
          const glm::mat4 matrix = reader.mat4(joint);
          for (int column = 0; column < 4; column++) {
            if (!is_finite(glm::vec3(matrix[column]))) {
              throw Fault("inverseBindMatrices", "a matrix is not finite");
            }
          }
          skin.joint_from_mesh[joint] = glm::dmat4(matrix);
        }
      }
    }
    catch (const Fault &fault) {
      skin.joint_from_mesh.assign(source.joints.size(), glm::dmat4(1.0));
      warnings.add(what, std::string("bound at the origin: ") + fault.what());
    }
    scene.skins.push_back(std::move(skin));
  }
}

}  // namespace gnomon::gltf
