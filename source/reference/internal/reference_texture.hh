// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <glm/vec4.hpp>

namespace gnomon::reference {

/**
 * Looks up level 0 of a texture at \a uv: linear RGB and alpha, all in [0, 1]. Texels are filtered by the sampler's
 * magnification filter. Colours are decoded before they are filtered. (0, 0) is the outer corner of the first texel.
 */
[[nodiscard]] glm::dvec4 texture_at(const scene::Image &image, const scene::Texture &texture, const glm::dvec2 &uv);

}  // namespace gnomon::reference
