// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace gnomon::shaders {

/** Text of a file under `shaders/` at build time; nothing if there is no such file. \a path: relative to `shaders/`. */
[[nodiscard]] std::optional<std::string_view> file(std::string_view path);

/** Paths of all files, sorted. */
[[nodiscard]] std::vector<std::string_view> paths();

}  // namespace gnomon::shaders
