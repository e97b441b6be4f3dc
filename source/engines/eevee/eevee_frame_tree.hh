// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::eevee {

/** A part of what a frame consists of, or was spared; its children are parts of it. */
struct FrameNode {
  std::string what;
  bool is_made = false;
  /** The reason why it was made, or why it was left out. */
  std::string why{};
  /** On the device; of a node with children, theirs together. */
  std::optional<std::size_t> bytes{};
  /** Written by the host since it was made. */
  std::optional<std::uint64_t> upload_bytes{};
  /** On the device, in the last picture whose times were taken. */
  std::optional<double> seconds{};
  /** Of what `what` names: programs, runs, layers, instances. */
  std::optional<std::uint64_t> count{};
  std::vector<FrameNode> children{};
};

/** The child called \a what; nullptr: there is none. */
[[nodiscard]] const FrameNode *find(const FrameNode &node, std::string_view what);

}  // namespace gnomon::eevee
