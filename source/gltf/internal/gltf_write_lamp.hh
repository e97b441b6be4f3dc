// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_write_json.hh"
#include "scene.hh"

#include <string>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** A glTF camera. All functions here throw Fault. */
[[nodiscard]] std::string camera_json(const scene::Camera &camera);

/** A light of KHR_lights_punctual. \pre not an area lamp, which is written as extras only */
[[nodiscard]] std::string light_json(const scene::Lamp &lamp);

/** Adds the extras of a node with \a camera, except for gnomon_camera_name. */
void add_camera_extras(const scene::Camera &camera, JsonText &extras);

/** Adds the extras of a node with \a lamp, except for gnomon_lamp_name. */
void add_lamp_extras(const scene::Lamp &lamp, JsonText &extras);

}  // namespace gnomon::gltf
