// SPDX-License-Identifier: MIT
#pragma once

#include "internal/measure_gltf.hh"

/** The files that stability is measured on serve tests too. */
namespace gnomon::test {

using namespace measure::gltf;

}  // namespace gnomon::test
