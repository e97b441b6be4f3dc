// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <optional>

namespace gnomon::unlit {

/**
 * A camera that covers the lit side of the objects in \a bounds_ws, as seen from \a lamp. For a spot, the camera has
 * the spot's opening angle. For a sun, it is orthographic and contains all of \a bounds_ws. For point and area lamps,
 * it has a field of view of 60 degrees towards the centre of the bounds, or along the lamp's axis if the lamp is at the
 * centre.
 *
 * \return the camera in the coordinates of \a lamp and \a bounds_ws; nothing for a hemi lamp and for empty bounds.
 */
[[nodiscard]] std::optional<scene::PlacedCamera> depth_camera_of(const scene::PlacedLamp &lamp,
                                                                 const scene::Bounds &bounds_ws);

}  // namespace gnomon::unlit
