// SPDX-License-Identifier: MIT
#include "shared/eevee_material_shared.h"
#include "shared/slots_shared.h"

layout(std140, binding = LAYER_BLOCK_SLOT) readonly buffer layer_block
{
  LayerData layer_materials[];
};
