// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_model.hh"

#include <vector>

/** How the nodes of a file are connected. Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * The roots of the default scene; if there is none, of the first scene; if there is none, of the file. \throws Fault if
 * the nodes are not trees, or a root is not one.
 */
[[nodiscard]] std::vector<int> scene_roots(const Model &model);

}  // namespace gnomon::gltf
