// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

namespace gnomon::cli {

/**
 * Hash of a glTF file and of the files that it names.
 * \throws std::runtime_error naming the file where it cannot be read; one that it names may be missing.
 */
[[nodiscard]] std::string scene_fingerprint(const std::filesystem::path &path);

/** Hash of the program that runs, or "" where the system does not show it. */
[[nodiscard]] std::string program_fingerprint();

}  // namespace gnomon::cli
