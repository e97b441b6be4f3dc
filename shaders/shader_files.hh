// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace gnomon::shaders {

/** The text of a file under `shaders/`, as it was when the program was built; nothing where there is none. */
[[nodiscard]] std::optional<std::string_view> file(std::string_view path);

/** All of them, sorted. */
[[nodiscard]] std::vector<std::string_view> paths();

}  // namespace gnomon::shaders
