// SPDX-License-Identifier: MIT
#pragma once

#include "scene_types.hh"

namespace gnomon::scene {

/**
 * \a image with at most \a size_max texels along both edges, and about the same ratio of its edges. Each texel is the
 * mean of the area that it covers: of decoded colours if \a is_color is true (\see TextureInput), and of the values
 * otherwise. An image that is small enough is returned as it is. \pre \a size_max > 0
 */
[[nodiscard]] Image reduced(Image image, std::uint32_t size_max, bool is_color);

}  // namespace gnomon::scene
