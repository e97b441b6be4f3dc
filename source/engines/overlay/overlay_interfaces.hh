// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_interface_table.hh"

namespace gnomon::overlay {

/** The interfaces of the programs, one table for each ShaderId, in order. Variant keys are Feature masks. */
[[nodiscard]] std::span<const gpu::InterfaceTable> interface_tables();

}  // namespace gnomon::overlay
