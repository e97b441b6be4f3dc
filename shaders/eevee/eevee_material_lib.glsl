// SPDX-License-Identifier: MIT
// For fragment shaders: the material of the surface.
#include "shared/eevee_material_shared.h"
#include "shared/slots_shared.h"

layout(location = 2) flat in uint surface_material;

// Blended casters read their opacity from full_material_block.
#ifndef USE_OPACITY_THRESHOLD
layout(std140, binding = MATERIAL_BLOCK_SLOT) readonly buffer material_block
{
  MaterialData materials[];
};
#endif
