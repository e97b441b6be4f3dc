// SPDX-License-Identifier: MIT
#pragma once

#include "internal/measure_gltf.hh"

/** Tests use the same glTF files as the stability cases. */
namespace gnomon::test {

using namespace measure::gltf;

}  // namespace gnomon::test
