// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_model.hh"

#include <cstddef>
#include <span>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** parse_document reads this many bytes past the end of the document, whatever they hold. */
[[nodiscard]] std::size_t document_padding();

/**
 * A glTF 2.0 document in JSON. What the importer does not read is not checked, beyond being JSON. Of properties of the
 * same name the last counts.
 *
 * \throws Fault that names the place in the document; std::bad_alloc.
 */
[[nodiscard]] Model parse_document(std::span<const unsigned char> json);

}  // namespace gnomon::gltf
