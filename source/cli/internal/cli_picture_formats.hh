// SPDX-License-Identifier: MIT
#pragma once

#include "cli_picture.hh"

#include <optional>

/** One function for each format of read_picture(), which adds the file's name to what they throw. */
namespace gnomon::cli {

/** So that a damaged header does not ask for all memory. \throws std::runtime_error for too small and large edges. */
void check_edges(std::int64_t width, std::int64_t height);

/** Nothing if \a path is not an EXR file. */
[[nodiscard]] std::optional<Picture> read_exr_picture(const std::filesystem::path &path);
[[nodiscard]] Picture read_hdr_picture(std::span<const unsigned char> file);

}  // namespace gnomon::cli
