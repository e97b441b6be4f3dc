// SPDX-License-Identifier: MIT
#include "internal/gltf_triangles.hh"

#include "internal/gltf_model.hh"

namespace gnomon::gltf {

void Losses::report(Warnings &warnings, const std::string &what, scene::Topology topology) const
{
  const bool is_triangles = topology == scene::Topology::Triangles;
  const std::string one = is_triangles ? "triangle" : topology == scene::Topology::Lines ? "line" : "point";
  const auto add = [&](std::uint64_t count, const std::string &reason) {
    if (count > 0) {
      warnings.add_counted(what, count, reason);
    }
  };
  add(out_of_range, one + " left out: a vertex index is out of range");
  add(non_finite, one + " left out: a position is not finite or beyond 1e12 m");
  add(flat, one + (is_triangles ? " left out: it has no area" : " left out: it has no length"));
  add(incomplete, "vertex left over at the end: it makes no " + one);
  add(bad_normals,
      std::string("normal replaced by ") + (is_triangles ? "that of a face" : "+Z") + ": it was zero or not finite");
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

std::vector<Line> lines_of(int mode, std::uint32_t count, Losses &losses)
{
  std::vector<Line> lines;
  const bool is_list = mode == Model::Lines;
  const std::uint32_t line_count = is_list ? count / 2 : count < 2 ? 0 : count - 1;
  losses.incomplete = is_list || line_count == 0 ? count - 2 * line_count : 0;
  lines.reserve(std::size_t(line_count) + 1);
  for (std::uint32_t i = 0; i < line_count; i++) {
    lines.push_back(is_list ? Line{2 * i, 2 * i + 1} : Line{i, i + 1});
  }
  if (mode == Model::LineLoop && line_count > 0) {
    lines.push_back({count - 1, 0});
  }
  return lines;
}

std::optional<scene::Topology> topology_of(int mode)
{
  switch (mode) {
    case Model::Triangles:
    case Model::TriangleStrip:
    case Model::TriangleFan: return scene::Topology::Triangles;
    case Model::Lines:
    case Model::LineLoop:
    case Model::LineStrip: return scene::Topology::Lines;
    case Model::Points: return scene::Topology::Points;
    default: return std::nullopt;
  }
}

}  // namespace gnomon::gltf
