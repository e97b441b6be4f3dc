// SPDX-License-Identifier: MIT
#pragma once

#include "scene_world.hh"

#include <glm/mat4x4.hpp>

namespace gnomon::scene {

/**
 * A neutral studio for a scene that has neither lamps nor a world: a bright room with a soft box to the left of the
 * camera at \a world_from_camera and above it, a weaker one to its right, and one behind the scene. +Y is up. A white
 * surface that faces the first box has a radiance of about 1.
 */
[[nodiscard]] World studio_world(const glm::dmat4 &world_from_camera);

}  // namespace gnomon::scene
