// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <glm/vec4.hpp>

namespace gnomon::reference {

/**
 * A texture at \a uv at its full size: linear RGB, and alpha, all in [0, 1]. Between texels as the sampler says for
 * magnified textures; colours are decoded before they are mixed. (0, 0) is the outer corner of the first texel.
 */
[[nodiscard]] glm::dvec4 texture_at(const scene::Image &image, const scene::Texture &texture, const glm::dvec2 &uv);

}  // namespace gnomon::reference
