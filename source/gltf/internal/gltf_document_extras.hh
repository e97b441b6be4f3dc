// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_json.hh"
#include "internal/gltf_model.hh"

#include <string>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * Adds the members of \a value whose names start with "gnomon_" to \a extras. A value that is not an object belongs to
 * another program and is ignored. \a name: of the thing with the extras. \throws Fault that names the place.
 */
void read_extras(const Place &place, const std::string &name, const JsonValue &value, Model::Extras &extras);

}  // namespace gnomon::gltf
