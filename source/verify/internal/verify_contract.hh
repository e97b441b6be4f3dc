// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <string>
#include <vector>

namespace gnomon::verify {

/**
 * What in \a scene is not as scene.hh promises of an imported scene, each naming the element: what is not finite, out
 * of range or of the wrong size. Internal to source/verify, and for tests.
 */
[[nodiscard]] std::vector<std::string> contract_faults(const scene::Scene &scene);

}  // namespace gnomon::verify
