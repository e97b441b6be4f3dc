// SPDX-License-Identifier: MIT
#include "internal/gltf_triangles.hh"

#include "internal/gltf_model.hh"

namespace gnomon::gltf {

void Losses::report(Warnings &warnings, const std::string &what) const
{
  const auto add = [&](std::uint64_t count, const char *reason) {
    if (count > 0) {
      warnings.add_counted(what, count, reason);
    }
  };
  add(out_of_range, "triangle left out: a vertex index is out of range");
  add(non_finite, "triangle left out: a position is not finite or beyond 1e12 m");
  add(flat, "triangle left out: it has no area");
  add(incomplete, "vertex left over at the end: it makes no triangle");
  add(bad_normals, "normal replaced by that of a face: it was zero or not finite");
  add(bad_uvs, "texture coordinate replaced by 0: it was not finite or beyond 1e6");
  add(bad_colors, "vertex colour limited to 0 to 1: it was not finite or outside");
}

std::vector<Triangle> triangles_of(int mode, std::uint32_t count, Losses &losses)
{
  std::vector<Triangle> triangles;
  const std::uint32_t triangle_count = mode == Model::Triangles ? count / 3 : count < 3 ? 0 : count - 2;
  const std::uint32_t used_count = mode == Model::Triangles ? 3 * triangle_count : triangle_count > 0 ? count : 0;
  losses.incomplete = count - used_count;
  triangles.reserve(triangle_count);
  for (std::uint32_t i = 0; i < triangle_count; i++) {
    switch (mode) {
      case Model::TriangleStrip:
        // Every other triangle is reversed, so that all have the same winding.
        triangles.push_back({i, i + 1 + i % 2, i + 2 - i % 2});
        break;
      case Model::TriangleFan: triangles.push_back({i + 1, i + 2, 0}); break;
      default: triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
  }
  return triangles;
}

bool is_drawn(int mode)
{
  return mode == Model::Triangles || mode == Model::TriangleStrip || mode == Model::TriangleFan;
}

std::string mode_reason(int mode)
{
  if (mode > Model::TriangleFan) {
    return "primitive left out: mode " + std::to_string(mode) + " is unknown";
  }
  return mode == Model::Points ? "primitive left out: points are not drawn" : "primitive left out: lines are not drawn";
}

}  // namespace gnomon::gltf
