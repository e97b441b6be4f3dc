// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_frame_tree.hh"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace gnomon::cli {

/** For example "5.9 MiB"; below 1 KiB in bytes. */
[[nodiscard]] std::string bytes_text(std::uint64_t bytes);

/** For example "12.3 ms"; in µs, ms or s. */
[[nodiscard]] std::string seconds_text(double seconds);

/**
 * One line for each node in columns: `+` made or `-` left out, name, count, bytes, device time and reason. Nodes that
 * are left out keep their position in the tree.
 */
[[nodiscard]] std::string tree_text(const eevee::FrameNode &root);

/** The same as JSON: keys are FrameNode's members, in seconds and bytes. Absent values have no key. */
[[nodiscard]] nlohmann::json tree_json(const eevee::FrameNode &node);

}  // namespace gnomon::cli
