// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_picture_layers.hh"

#include <cstdint>
#include <string>

/**
 * Cryptomatte 1.2 (Friedman and Jones, "Fully automatic ID mattes with support for motion blur and transparency",
 * Siggraph 2015; specification at github.com/Psyop/Cryptomatte): for each pixel, the things that cover it and the part
 * of the pixel that each covers, so that compositing programs make antialiased mattes of them by name.
 */
namespace gnomon::eevee {

/** MurmurHash3_x86_32 of Austin Appleby with the seed 0. */
[[nodiscard]] std::uint32_t murmur_hash3(std::string_view text);
/** The id of a name: its hash as a float, with a bit of the exponent flipped where it would not be a normal number. */
[[nodiscard]] float cryptomatte_id(std::string_view name);

/** The names of objects by draw::ObjectIndex: those of their nodes or of their materials. Empty: no object. */
[[nodiscard]] std::vector<std::string> object_names(SceneRenderer &renderer, bool has_materials);

/** Layers of four values, each of which holds two things: id, coverage, id, coverage. */
inline constexpr std::size_t cryptomatte_layer_count = 3;
using CryptomatteLayers = std::array<std::vector<glm::vec4>, cryptomatte_layer_count>;

/**
 * The things of each pixel by their coverage, the largest first. Those that find no place are left out. \a pixels:
 * SurfaceLayers::objects. \a names: of object_names. Things with equal names are one.
 */
[[nodiscard]] CryptomatteLayers cryptomatte_layers(std::span<const std::vector<Coverage>> pixels,
                                                   std::span<const std::string> names);

}  // namespace gnomon::eevee
