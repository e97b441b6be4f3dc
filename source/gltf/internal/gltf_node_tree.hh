// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_model.hh"
#include "internal/gltf_report.hh"

#include <vector>

/** How the nodes of a file are connected. Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * The roots of the default scene; if there is none, of the first scene; if there is none, of the file. Each node of the
 * scene is reached from one root, once: \a warnings name listed nodes that have a parent. \throws Fault if the nodes
 * are not trees
 */
[[nodiscard]] std::vector<int> scene_roots(const Model &model, Warnings &warnings);

}  // namespace gnomon::gltf
