// SPDX-License-Identifier: MIT
#pragma once

#include "internal/verify_gltf.hh"

/** Tests use the same glTF files as the stability cases. */
namespace gnomon::test {

using namespace verify::gltf;

}  // namespace gnomon::test
