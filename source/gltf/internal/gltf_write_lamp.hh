// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_write_json.hh"
#include "scene.hh"

#include <string>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** A camera of glTF. \throws Fault, as the others. */
[[nodiscard]] std::string camera_json(const scene::Camera &camera);

/** A light of KHR_lights_punctual. Not for area lamps, which are extras alone. */
[[nodiscard]] std::string light_json(const scene::Lamp &lamp);

/** Adds the extras that a node with \a lamp has, but for its name. */
void add_lamp_extras(const scene::Lamp &lamp, JsonText &extras);

}  // namespace gnomon::gltf
