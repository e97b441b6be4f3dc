// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * The place and the kind of the first fault of a text that is not JSON (RFC 8259): "line 3, column 7 (byte 57): a comma
 * before '}'". Lines and columns count from 1, bytes from 0; a column is a byte. Empty if no fault is found. The time
 * is linear in the size, and no depth is too large. For messages: the parser decides which texts are valid.
 */
[[nodiscard]] std::string json_fault(std::string_view text);

}  // namespace gnomon::gltf
