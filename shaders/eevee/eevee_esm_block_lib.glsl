// SPDX-License-Identifier: MIT
#include "shared/eevee_esm_shared.h"
#include "shared/slots_shared.h"

layout(std140, binding = ESM_BLOCK_SLOT) uniform esm_block
{
  EsmBlock esm;
};
