// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"

#include <glm/mat4x4.hpp>

#include <vector>

/** EXT_mesh_gpu_instancing. Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * The matrix of each instance, from the instance's space to the node's. Rotations are normalised; a rotation without
 * length or with NaN is ignored.
 *
 * \throws Fault naming the attribute that cannot be read, or whose count differs from that of the others.
 */
[[nodiscard]] std::vector<glm::dmat4> instance_matrices(const File &file, const Model::Instances &instances);

}  // namespace gnomon::gltf
