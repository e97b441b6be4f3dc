// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>

/** Colours of Inspection::texel_density. */
namespace gnomon::eevee {

/** The scale of colours is from 1 / texel_density_max to this. */
inline constexpr float texel_density_max = 4.0F;

/**
 * The display colour of \a density, which is above 0: red where a texel is as large as 4 pixels or larger, yellow at 2
 * pixels, green where it is as large as a pixel, cyan at half a pixel, blue at a quarter and below.
 */
[[nodiscard]] glm::vec3 texel_density_color(float density);

/**
 * Colour a picture by \a density, one value for each pixel. Its own brightness remains in part; pixels with a density
 * of 0 become grey. \a rgba: display-referred, four bytes for each pixel; alpha does not change.
 */
void show_texel_density(std::span<std::uint8_t> rgba, std::span<const float> density);

}  // namespace gnomon::eevee
