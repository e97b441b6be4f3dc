// SPDX-License-Identifier: MIT
#include "shared/eevee_shape_shared.h"
#include "shared/slots_shared.h"

layout(binding = LTC_TABLE_SLOT) uniform sampler2D ltc_table;
