// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_report.hh"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

/** Triangles of a primitive, and counts of its faults. Internal to source/gltf. */
namespace gnomon::gltf {

using Triangle = std::array<std::uint32_t, 3>;

/** Counts of faulty triangles, vertices and attributes of a primitive. */
struct Losses {
  std::uint64_t out_of_range = 0;
  std::uint64_t non_finite = 0;
  std::uint64_t flat = 0;
  std::uint64_t incomplete = 0;
  std::uint64_t bad_normals = 0;
  std::uint64_t bad_uvs = 0;
  std::uint64_t bad_colors = 0;

  bool operator==(const Losses &) const = default;

  void report(Warnings &warnings, const std::string &what) const;
};

/** Whether primitives of this glTF mode consist of triangles. */
[[nodiscard]] bool is_drawn(int mode);

/** The reason for which a primitive of another mode is left out. */
[[nodiscard]] std::string mode_reason(int mode);

/** The triangles of a list, strip or fan of \a count vertices, as positions in that sequence, with glTF's winding. */
[[nodiscard]] std::vector<Triangle> triangles_of(int mode, std::uint32_t count, Losses &losses);

}  // namespace gnomon::gltf
