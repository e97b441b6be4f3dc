// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"
#include "internal/gltf_report.hh"
#include "scene.hh"

#include <glm/mat4x4.hpp>

#include <optional>

/** Lamps and cameras: what stands on a node and looks along its -Z. Internal to source/scene. */
namespace gnomon::scene::gltf {

/**
 * The rotation and place of \a world without its scale, shear or mirroring: a right-handed orthonormal frame that keeps
 * the direction of -Z exactly and that of +Y as nearly as it can. Axes that a zero scale took away are made up.
 */
[[nodiscard]] glm::dmat4 frame_of(const glm::dmat4 &world);

/**
 * The lamp on a node, if there is one. \a world is finite.
 *
 * \throws Fault that names the lamp, the key and the value, when one is of the wrong type or out of range.
 */
[[nodiscard]] std::optional<Lamp> lamp_on(const File &file, int node, const glm::dmat4 &world, Warnings &warnings);

/** The camera on a node, if there is one with usable numbers. \a world is finite. */
[[nodiscard]] std::optional<Camera> camera_on(const File &file, int node, const glm::dmat4 &world, Warnings &warnings);

/** Three quarters from the front and above, with +Y up, all of \a bounds in the frame. Empty bounds: the unit sphere.
 */
[[nodiscard]] Camera default_camera(const Bounds &bounds);

/** A sun over the shoulder of who looks through \a camera. */
[[nodiscard]] Lamp default_sun(const Camera &camera);

}  // namespace gnomon::scene::gltf
