// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <optional>
#include <string_view>

/** Reads cameras, and makes the default camera and lamp of files without one. Internal to source/gltf. */
namespace gnomon::gltf {

/** The camera on a node; empty if there is none, or if its numbers are invalid. */
[[nodiscard]] std::optional<scene::Camera> camera_on(const File &file, int node, Warnings &warnings);

/** Whether a camera may have the extra. */
[[nodiscard]] bool is_camera_extra(std::string_view key);

/** Name of the default camera, the default lamp and their nodes. */
constexpr const char *default_name = "default";

/**
 * A camera above and to the side of the front, with all of \a bounds in the frame. +Y is up. Empty bounds: the unit
 * sphere.
 */
[[nodiscard]] scene::PlacedCamera default_camera(const scene::Bounds &bounds);

/** A sun from above and from the left of \a camera. */
[[nodiscard]] scene::PlacedLamp default_sun(const scene::PlacedCamera &camera);

}  // namespace gnomon::gltf
