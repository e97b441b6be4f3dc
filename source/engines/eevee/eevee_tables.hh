// SPDX-License-Identifier: MIT
#pragma once

#include <span>

namespace gnomon::eevee {

/**
 * The content of the texture `ltc_table`: 2 · LTC_TABLE_SIZE by LTC_TABLE_SIZE texels in RGBA32F. In each half, columns
 * are the square root of alpha, 0 to 1, and rows are the square root of 1 - cos of the view direction, 0 to 1. The left
 * half contains the matrix of ltc_transformed. The right half contains the directional albedo of the lobe, the same
 * albedo weighted by Schlick's fifth power, the hemispherical mean of the albedo, and the directional albedo of a sheen
 * lobe. table_tools/ generates the table.
 */
[[nodiscard]] std::span<const float> ltc_table();

/**
 * The content of the texture `multiscatter_table`: MULTISCATTER_TABLE_SIZE² texels in RGBA32F, the directional and mean
 * albedos of the specular lobe. eevee_multiscatter_shared.h describes the layout. table_tools/ generates the
 * table.
 */
[[nodiscard]] std::span<const float> multiscatter_table();

}  // namespace gnomon::eevee
