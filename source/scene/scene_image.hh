// SPDX-License-Identifier: MIT
#pragma once

#include "scene_types.hh"

#include <glm/ext/vector_uint2.hpp>

#include <cstdint>
#include <vector>

namespace gnomon::scene {

/**
 * The use of the image of one of the material's slots. Coverage and Mask: the base colour of a surface without a
 * surface function, which may show what alpha hides.
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
 * cutoff. A texel of a level has the mean of the colours that it covers, weighted by what they cover, and the covered
 * part. A texel of the image covers the part alpha; of a mask, what \a mask says, with a colour if its own alpha is at
 * least the cutoff. Texels without a colour, and those of the image without alpha, have the colour of the next coarser
 * level that has one, so that filters between texels mix in no colour that is not seen. The texels repeat. Edges are
 * halved and rounded down.
 */
[[nodiscard]] std::vector<std::uint8_t> coverage_levels(const Image &image, const MaskCover &mask = {});

}  // namespace gnomon::scene
