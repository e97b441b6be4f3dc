// SPDX-License-Identifier: MIT
#include "internal/gltf_instances.hh"

#include "internal/gltf_accessor.hh"
#include "internal/gltf_node.hh"
#include "internal/gltf_report.hh"

#include <optional>

namespace gnomon::gltf {

std::vector<glm::dmat4> instance_matrices(const File &file, const Model::Instances &instances)
{
  std::optional<std::size_t> count;
  const auto open = [&](const char *name, int accessor, Model::ElementType type) {
    std::optional<AccessorReader> reader;
    if (accessor >= 0) {
      reader.emplace(file, accessor, type);
      if (count.value_or(reader->count()) != reader->count()) {
        throw Fault(name, "count differs from those of the other attributes of EXT_mesh_gpu_instancing");
      }
      count = reader->count();
    }
    return reader;
  };
  const std::optional<AccessorReader> translations =
      open("TRANSLATION", instances.translation, Model::ElementType::Vec3);
  const std::optional<AccessorReader> rotations = open("ROTATION", instances.rotation, Model::ElementType::Vec4);
  const std::optional<AccessorReader> scales = open("SCALE", instances.scale, Model::ElementType::Vec3);
  if (!count) {
    throw Fault("EXT_mesh_gpu_instancing", "has no attribute TRANSLATION, ROTATION or SCALE");
  }
  std::vector<glm::dmat4> matrices;
  for (std::size_t i = 0; i < *count; i++) {
    const glm::dvec4 rotation = rotations ? glm::dvec4(rotations->vec4(i)) : glm::dvec4(0.0, 0.0, 0.0, 1.0);
    const glm::dvec3 scale = scales ? glm::dvec3(scales->vec3(i)) : glm::dvec3(1.0);
    const glm::dvec3 translation = translations ? glm::dvec3(translations->vec3(i)) : glm::dvec3(0.0);
    matrices.push_back(matrix_from(translation, rotation, scale));
  }
  return matrices;
}

}  // namespace gnomon::gltf
