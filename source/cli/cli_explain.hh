// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_frame_tree.hh"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace gnomon::cli {

/** "5.9 MiB"; below 1 KiB in bytes. */
[[nodiscard]] std::string bytes_text(std::uint64_t bytes);

/** "12.3 ms"; µs and s where those are nearer. */
[[nodiscard]] std::string seconds_text(double seconds);

/**
 * One line a node: `+` made or `-` left out, what, how many, bytes, device time, and why, in columns. What is left out
 * is in its place in the tree.
 */
[[nodiscard]] std::string tree_text(const eevee::FrameNode &root);

/** The same for scripts: keys as FrameNode's members, in seconds and bytes; what a node lacks has no key. */
[[nodiscard]] nlohmann::json tree_json(const eevee::FrameNode &node);

}  // namespace gnomon::cli
