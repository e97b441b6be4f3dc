// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <optional>

/** Reads lamps. Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * The lamp on a node, if there is one.
 *
 * \throws Fault that names the lamp, the key and the value, if a value has the wrong type or is out of range.
 */
[[nodiscard]] std::optional<scene::Lamp> lamp_on(const File &file, int node, Warnings &warnings);

}  // namespace gnomon::gltf
