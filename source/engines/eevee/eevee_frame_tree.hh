// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::eevee {

/** A node of the report of a frame: a part that was made or left out. Its children are parts of it. */
struct FrameNode {
  std::string what;
  bool is_made = false;
  /** The reason why the part was made or left out. */
  std::string why{};
  /** Size on the device. For a node with children, the sum of their sizes. */
  std::optional<std::size_t> bytes{};
  /** Bytes that the host wrote since the creation of the resource. */
  std::optional<std::uint64_t> upload_bytes{};
  /** Device time in the last picture that was timed. */
  std::optional<double> seconds{};
  /** The number of items that `what` names: programs, runs, layers or instances. */
  std::optional<std::uint64_t> count{};
  std::vector<FrameNode> children{};
};

/** Counters of the shadow layers that were submitted since the creation of the shadows. */
struct ShadowCounters {
  /** Number of updates of a lamp in which at least one layer was drawn. */
  std::uint64_t lamps_updated = 0;
  /** Number of layers drawn: faces of cubes, maps of spots, cascades of suns. */
  std::uint64_t faces_drawn = 0;
  /** Number of layers of updated lamps that were not drawn, because they are up to date, empty or not needed. */
  std::uint64_t faces_skipped = 0;
  /** Number of caster instances drawn. A caster counts once for each layer that it touches. */
  std::uint64_t caster_draws = 0;
};

/** The child of \a node with the name \a what; nullptr if there is none. */
[[nodiscard]] const FrameNode *find(const FrameNode &node, std::string_view what);

}  // namespace gnomon::eevee
