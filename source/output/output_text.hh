// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

/** Text for people. Names of files and of what is in them may have characters that terminals obey. */
namespace gnomon::output {

/**
 * \a name for a message of one line. Each control character of Unicode, each one that changes the direction of text or
 * begins a line, and each byte that is not UTF-8 becomes '?'.
 */
[[nodiscard]] std::string printable(std::string_view name);

/** \a text in the same way, but with its tabs, and with its line breaks, of which each is followed by \a indent. */
[[nodiscard]] std::string printable_text(std::string_view text, std::string_view indent = {});

}  // namespace gnomon::output
