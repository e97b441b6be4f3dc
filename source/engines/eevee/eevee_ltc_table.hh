// SPDX-License-Identifier: MIT
#pragma once

#include <span>

namespace gnomon::eevee {

/**
 * The content of `ltc_table`, RGBA32F texels of 2 · LTC_TABLE_SIZE by LTC_TABLE_SIZE. Columns: square root of alpha, 0
 * to 1; rows: square root of 1 - cos of the view direction, 0 to 1. Left: the matrix of ltc_transformed. Right:
 * directional albedo of the lobe, the same weighted by Schlick's fifth power, and the albedo's hemispherical mean.
 * ltc_tool/ makes it.
 */
[[nodiscard]] std::span<const float> ltc_table();

}  // namespace gnomon::eevee
