// SPDX-License-Identifier: MIT
#pragma once

#include "scene_types.hh"

namespace gnomon::scene {

/** The linear value of a channel that is encoded as sRGB (IEC 61966-2-1). \a value in [0, 1]. */
[[nodiscard]] float decoded_srgb(float value);

/**
 * \a image with at most \a size_max texels along both edges, and about the same ratio of its edges. Each texel is the
 * mean of the area that it covers: of decoded colours if \a is_color is true (\see TextureInput), and of the values
 * otherwise. An image that is small enough is returned as it is. \pre \a size_max > 0
 */
[[nodiscard]] Image reduced(Image image, std::uint32_t size_max, bool is_color);

}  // namespace gnomon::scene
