// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_report.hh"
#include "scene_types.hh"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/** Triangles, lines and points of a primitive, and counts of its faults. Internal to source/gltf. */
namespace gnomon::gltf {

using Triangle = std::array<std::uint32_t, 3>;
using Line = std::array<std::uint32_t, 2>;
using Point = std::array<std::uint32_t, 1>;

/** Counts of faulty triangles, lines, points, vertices and attributes of a primitive. */
struct Losses {
  std::uint64_t out_of_range = 0;
  std::uint64_t non_finite = 0;
  /** Triangles without area, and lines without length. */
  std::uint64_t flat = 0;
  std::uint64_t incomplete = 0;
  std::uint64_t bad_normals = 0;
  std::uint64_t bad_uvs = 0;
  std::uint64_t bad_colors = 0;

  bool operator==(const Losses &) const = default;

  void report(Warnings &warnings, const std::string &what, scene::Topology topology) const;
};

/** The topology of primitives of this glTF mode; empty: the mode is unknown. */
[[nodiscard]] std::optional<scene::Topology> topology_of(int mode);

/** The triangles of a list, strip or fan of \a count vertices, as positions in that sequence, with glTF's winding. */
[[nodiscard]] std::vector<Triangle> triangles_of(int mode, std::uint32_t count, Losses &losses);

/** The same for a list, strip or loop of lines. */
[[nodiscard]] std::vector<Line> lines_of(int mode, std::uint32_t count, Losses &losses);

}  // namespace gnomon::gltf
