// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <string>
#include <vector>

namespace gnomon::verify {

/**
 * Violations of the contract of scene.hh for imported scenes: values that are not finite, out of range or of the wrong
 * size. Each text names the element. Internal to source/verify, and for tests.
 */
[[nodiscard]] std::vector<std::string> contract_faults(const scene::Scene &scene);

}  // namespace gnomon::verify
