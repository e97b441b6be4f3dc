// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * Make a glTF document safe to hand to tinygltf, which takes a wrong type for an absent value, cuts integers to 32
 * bits, and refuses a whole file for one image that it cannot decode.
 *
 * Checks the type of every property that this import reads and the range of every index but those of and into textures,
 * and erases all others (animations, foreign extensions and extras), so that what is left is small and shallow.
 *
 * \throws Fault that names the place in the document.
 */
void check_document(nlohmann::json &document);

}  // namespace gnomon::gltf
