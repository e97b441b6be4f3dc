// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace gnomon::measure::page_files {

/** An embedded style sheet or script, by name. Empty if there is none with that name. */
[[nodiscard]] std::optional<std::string_view> file(std::string_view name);

/** Names of all embedded files, in the order in which a page contains them. */
[[nodiscard]] std::vector<std::string_view> paths();

}  // namespace gnomon::measure::page_files
