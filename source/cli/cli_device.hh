// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_create_device.hh"

namespace gnomon::cli {

/** A device of the backend \a name, with the cache of shaders. \throws gpu::Error */
[[nodiscard]] std::unique_ptr<gpu::Device> create_device(std::string_view name);

}  // namespace gnomon::cli
