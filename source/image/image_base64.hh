// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

namespace gnomon::image {

/** The text of \a bytes in a data URI (RFC 4648, with padding). */
[[nodiscard]] std::string base64(std::span<const unsigned char> bytes);

}  // namespace gnomon::image
