// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <optional>

namespace gnomon::unlit {

/**
 * A camera that sees what \a lamp shines on: the cone of a spot; for a sun a parallel view that holds all of
 * \a bounds_ws; for other lamps a view of 60 degrees towards the middle of the bounds, or along the lamp where it is
 * there. Nothing for a hemi lamp, and where there is nothing to be seen. World space of the scene.
 */
[[nodiscard]] std::optional<scene::PlacedCamera> depth_camera_of(const scene::PlacedLamp &lamp,
                                                                 const scene::Bounds &bounds_ws);

}  // namespace gnomon::unlit
