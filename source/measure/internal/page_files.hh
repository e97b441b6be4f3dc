// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace gnomon::measure::page_files {

/** A style sheet or script that a page holds, by name; nothing where there is none of it. */
[[nodiscard]] std::optional<std::string_view> file(std::string_view name);

/** All of them, in the order in which a page holds them. */
[[nodiscard]] std::vector<std::string_view> paths();

}  // namespace gnomon::measure::page_files
