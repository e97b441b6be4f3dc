// SPDX-License-Identifier: MIT
#pragma once

#include <span>

namespace gnomon::eevee {

/**
 * The content of the texture `multiscatter_table`: MULTISCATTER_TABLE_SIZE² texels in RGBA32F, the directional and mean
 * albedos of the specular lobe. eevee_multiscatter_shared.h describes the layout. multiscatter_tool/ generates the
 * table.
 */
[[nodiscard]] std::span<const float> multiscatter_table();

}  // namespace gnomon::eevee
