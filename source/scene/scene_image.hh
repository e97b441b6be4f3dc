// SPDX-License-Identifier: MIT
#pragma once

#include "scene_types.hh"

#include <glm/ext/vector_uint2.hpp>

#include <cstdint>
#include <vector>

namespace gnomon::scene {

/**
 * The use of the image of one of the material's slots. A base colour is Coverage or Mask if alpha hides texels of it,
 * as no mask with a cutoff of 0 does; a surface function may read hidden texels, therefore its base colour is neither.
 */
[[nodiscard]] ImageUse use_of(const Material &material, const TextureInput &input);

/** The linear value of a channel that is encoded as sRGB (IEC 61966-2-1). \a value in [0, 1]. */
[[nodiscard]] float decoded_srgb(float value);

/** The size, in texels, of an image of \a size after reduced(). */
[[nodiscard]] glm::uvec2 reduced_size(glm::uvec2 size, std::uint32_t size_max);

/**
 * \a image with at most \a size_max texels along both edges, and about the same ratio of its edges. Each texel is the
 * mean of the area that it covers, of values or of decoded colours as \a use says. With ImageUse::Mask and a
 * cutoff above 0, \a mask covers about as large a part of the result as of the image.
 * An image that is small enough is returned as it is. \pre \a size_max > 0
 */
[[nodiscard]] Image reduced(Image image, std::uint32_t size_max, ImageUse use, const MaskCover &mask = {});

/**
 * The texels of all mip levels, the finest first, for ImageUse::Coverage, or for ImageUse::Mask if \a mask has a
 * cutoff. A texel of a level stores its covered share as alpha, and the mean colour of its covered texels, weighted by
 * their shares. A texel of the image covers the share alpha; in a mask, the share that \a mask gives, and it has a
 * colour if its own alpha is at least the cutoff. Texels without a colour, and texels of the image with alpha 0, have
 * the colour of the next coarser level that has one, so that filters between texels mix in no hidden colour. The texels
 * repeat. Edges are halved and rounded down.
 */
[[nodiscard]] std::vector<std::uint8_t> coverage_levels(const Image &image, const MaskCover &mask = {});

}  // namespace gnomon::scene
