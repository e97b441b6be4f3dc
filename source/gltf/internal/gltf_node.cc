// SPDX-License-Identifier: MIT
#include "internal/gltf_node.hh"

#include "internal/gltf_extra.hh"
#include "internal/gltf_world.hh"

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace gnomon::gltf {

namespace {

constexpr std::array<std::string_view, 2> name_extras{"gnomon_lamp_name", "gnomon_camera_name"};

[[noreturn]] void fail_extra(const Model::Node &node, int index, const std::string &key, const char *wanted)
{
  throw Fault(label("node", node.name, static_cast<std::size_t>(index)),
              key + " is " + written(node.extras.at(key)) + ", and must be " + wanted);
}

}  // namespace

bool is_node_extra(std::string_view key)
{
  bool is_flag = false;
  for_each_flag([&](const auto &row) { is_flag |= extra_key(row) == key; });
  return is_flag || is_world_extra(key) || std::find(name_extras.begin(), name_extras.end(), key) != name_extras.end();
}

void read_flags(const Model::Node &source, int index, scene::Node &node)
{
  // Most nodes have no extras.
  if (!source.extras.empty()) {
    for_each_flag([&](const auto &row) {
      const std::string key = extra_key(row);
      if (const auto found = source.extras.find(key); found != source.extras.end()) {
        const bool *value = std::get_if<bool>(&found->second);
        if (value == nullptr) {
          fail_extra(source, index, key, "true or false");
        }
        node.*row.member = *value;
      }
    });
  }
  node.is_visible = node.is_visible && source.is_visible;
}

bool is_rotation(const glm::dvec4 &xyzw)
{
  const double length = glm::length(xyzw);
  return length > 0.0 && std::isfinite(length);
}

glm::dmat4 matrix_from(const glm::dvec3 &translation, const glm::dvec4 &rotation_xyzw, const glm::dvec3 &scale)
{
  glm::dmat4 matrix(1.0);
  if (is_rotation(rotation_xyzw)) {
    const glm::dvec4 unit = rotation_xyzw / glm::length(rotation_xyzw);
    matrix = glm::mat4_cast(glm::dquat(unit.w, unit.x, unit.y, unit.z));
  }
  for (int axis = 0; axis < 3; axis++) {
    matrix[axis] *= scale[axis];
    matrix[3][axis] = translation[axis];
  }
  return matrix;
}

glm::dmat4 matrix_of(const Model::Node &node, const std::function<std::string()> &what, Warnings &warnings)
{
  glm::dmat4 matrix(1.0);
  if (node.matrix) {
    for (std::size_t i = 0; i < 16; i++) {
      matrix[int(i / 4)][int(i % 4)] = (*node.matrix)[i];
    }
    if (matrix[0][3] != 0.0 || matrix[1][3] != 0.0 || matrix[2][3] != 0.0 || matrix[3][3] != 1.0) {
      warnings.add(what(), "the last row of its matrix is not 0 0 0 1 and is not used");
      matrix[0][3] = matrix[1][3] = matrix[2][3] = 0.0;
      matrix[3][3] = 1.0;
    }
    return matrix;
  }
  const auto &[x, y, z, w] = node.rotation;
  const glm::dvec4 rotation(x, y, z, w);
  if (!is_rotation(rotation)) {
    warnings.add(what(), "its rotation has no length and is not used");
  }
  return matrix_from({node.translation[0], node.translation[1], node.translation[2]}, rotation,
                     {node.scale[0], node.scale[1], node.scale[2]});
}

std::string thing_name(const Model::Node &node, const char *key, const std::string &fallback, const char *kind,
                       int index)
{
  if (const auto found = node.extras.find(key); found != node.extras.end()) {
    const std::string *name = std::get_if<std::string>(&found->second);
    if (name == nullptr) {
      fail_extra(node, index, key, "a string");
    }
    return *name;
  }
  if (!node.name.empty()) {
    return node.name;
  }
  return fallback.empty() ? std::string(kind) + " on node " + std::to_string(index) : fallback;
}

}  // namespace gnomon::gltf
