// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <optional>

/** Reads lamps and cameras. Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * The lamp on a node, if there is one.
 *
 * \throws Fault that names the lamp, the key and the value, when one is of the wrong type or out of range.
 */
[[nodiscard]] std::optional<scene::Lamp> lamp_on(const File &file, int node, Warnings &warnings);

/** The camera on a node, if there is one with usable numbers. */
[[nodiscard]] std::optional<scene::Camera> camera_on(const File &file, int node, Warnings &warnings);

/** Three quarters from the front and above, with +Y up, all of \a bounds in the frame. Empty bounds: the unit sphere.
 */
[[nodiscard]] scene::PlacedCamera default_camera(const scene::Bounds &bounds);

/** A sun from above and from the left of \a camera. */
[[nodiscard]] scene::PlacedLamp default_sun(const scene::PlacedCamera &camera);

}  // namespace gnomon::gltf
