// SPDX-License-Identifier: MIT
#include "shared/eevee_material_shared.h"
#include "shared/slots_shared.h"

layout(std140, binding = FULL_MATERIAL_BLOCK_SLOT) readonly buffer full_material_block
{
  FullMaterialData full_materials[];
};
