// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include <filesystem>
#include <string>
#include <string_view>

namespace gnomon::cli {

/**
 * Hash of all parts of a scene that affect pictures, also of other frames, and of the names of its things. It depends
 * neither on the paths nor on the encoding of the files.
 */
[[nodiscard]] std::string scene_fingerprint(const scene::Scene &scene);

[[nodiscard]] std::string text_fingerprint(std::string_view text);

/** Hash of the content of a file; "" if it cannot be read. */
[[nodiscard]] std::string file_fingerprint(const std::filesystem::path &path);

/** Hash of the running program; "" if the system does not provide it. */
[[nodiscard]] std::string program_fingerprint();

}  // namespace gnomon::cli
