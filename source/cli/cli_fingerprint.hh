// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

namespace gnomon::cli {

/** Hash of what a file holds; of nothing, where it cannot be read. */
[[nodiscard]] std::string fingerprint_of(const std::filesystem::path &path);

}  // namespace gnomon::cli
