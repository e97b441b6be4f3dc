// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <optional>

/** Reads cameras, and makes the camera and the lamp of files without one. Internal to source/gltf. */
namespace gnomon::gltf {

/** The camera on a node, if there is one with usable numbers. */
[[nodiscard]] std::optional<scene::Camera> camera_on(const File &file, int node, Warnings &warnings);

/** Name of the camera and the lamp below, and of their nodes. */
constexpr const char *default_name = "default";

/** Three quarters from the front and above, with +Y up, all of \a bounds in the frame. Empty bounds: the unit sphere.
 */
[[nodiscard]] scene::PlacedCamera default_camera(const scene::Bounds &bounds);

/** A sun from above and from the left of \a camera. */
[[nodiscard]] scene::PlacedLamp default_sun(const scene::PlacedCamera &camera);

}  // namespace gnomon::gltf
