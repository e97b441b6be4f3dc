// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_frame_tree.hh"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace gnomon::cli {

/**
 * One line for each node in columns: `+` made or `-` left out, name, count, bytes, device time and reason. Nodes that
 * are left out keep their position in the tree.
 */
[[nodiscard]] std::string tree_text(const eevee::FrameNode &root);

/** The same as JSON: keys are FrameNode's members, in seconds and bytes. Absent values have no key. */
[[nodiscard]] nlohmann::json tree_json(const eevee::FrameNode &node);

}  // namespace gnomon::cli
