// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** The relative URI of a file from \a folder. Empty if there is no such file, or no path to it. */
[[nodiscard]] std::string uri_of_file(const std::string &path, const std::filesystem::path &folder);

}  // namespace gnomon::gltf
