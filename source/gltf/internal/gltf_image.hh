// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <cstdint>
#include <span>
#include <string>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * A PNG or JPEG file in memory as an Image without a name. 16-bit values are rounded to 8, grey becomes three equal
 * colours, and what has no alpha is opaque. Profiles and gammas in the file are not used, as glTF asks.
 *
 * \throws Fault that names \a what, for a file that is cut off, damaged, of another format, or of more than
 * \a texel_count_max texels.
 */
[[nodiscard]] scene::Image decoded_image(std::span<const unsigned char> bytes, const std::string &what,
                                         std::uint64_t texel_count_max);

}  // namespace gnomon::gltf
