// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>
#include <vector>

/** The files of tables/, as cmake/embed_files.cmake embeds them: floats in the byte order of x86 and ARM. */
namespace gnomon::eevee::table_files {

/** Content of a file; nothing if there is no such file. */
[[nodiscard]] std::optional<std::string_view> file(std::string_view path);

/** Names of all files, sorted. */
[[nodiscard]] std::vector<std::string_view> paths();

}  // namespace gnomon::eevee::table_files
