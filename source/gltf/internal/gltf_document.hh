// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_model.hh"
#include "internal/gltf_report.hh"

#include <cstddef>
#include <span>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** Number of bytes, of any value, that must follow the document in memory. */
[[nodiscard]] std::size_t document_padding();

/**
 * Parses a glTF 2.0 document in JSON. Properties that the importer does not use are checked only for JSON syntax. The
 * last of several properties of the same name counts. Zero bytes at the end are dropped, with a warning.
 *
 * \throws Fault that names the place in the document; std::bad_alloc.
 */
[[nodiscard]] Model parse_document(std::span<const unsigned char> json, Warnings &warnings);

}  // namespace gnomon::gltf
