// SPDX-License-Identifier: MIT
// Points and lines of glTF files.
#include "gltf/gltf_check.hh"

#include "gltf_export.hh"

namespace gnomon::test {
namespace {

using scene::Mesh;
using scene::Scene;
using scene::Topology;

/** A mesh of one primitive of four vertices with this mode. */
Mesh import_mode(int mode, const std::vector<std::uint16_t> &indices = {})
{
  GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  json primitive = {{"attributes", {{"POSITION", positions}}}, {"mode", mode}};
  if (!indices.empty()) {
    primitive["indices"] = builder.accessor(indices, Uint16, "SCALAR");
  }
  builder.node({{"mesh", builder.mesh(primitive)}});
  return nth(import(builder).meshes(), 0);
}

std::vector<glm::vec3> corner_positions(const Mesh &mesh)
{
  std::vector<glm::vec3> result;
  for (const std::uint32_t index : mesh.indices) {
    result.push_back(mesh.positions[index]);
  }
  return result;
}

TEST(GltfLines, ListsStripsAndLoopsConnectTheVerticesThatGltfSays)
{
  const glm::vec3 a(0, 0, 0);
  const glm::vec3 b(1, 0, 0);
  const glm::vec3 c(1, 1, 0);
  const glm::vec3 d(0, 1, 0);
  const auto expect = [](const Mesh &mesh, Topology topology, const std::vector<glm::vec3> &corners) {
    EXPECT_EQ(mesh.topology, topology);
    EXPECT_EQ(corner_positions(mesh), corners);
  };
  expect(import_mode(0), Topology::Points, {a, b, c, d});
  expect(import_mode(1), Topology::Lines, {a, b, c, d});
  expect(import_mode(2), Topology::Lines, {a, b, b, c, c, d, d, a});
  expect(import_mode(3), Topology::Lines, {a, b, b, c, c, d});
  expect(import_mode(0, {3, 1}), Topology::Points, {d, b});
  expect(import_mode(1, {3, 1, 0, 2}), Topology::Lines, {d, b, a, c});
  expect(import_mode(2, {3, 1, 0}), Topology::Lines, {d, b, b, a, a, d});
  expect(import_mode(3, {3, 1, 0}), Topology::Lines, {d, b, b, a});
}

TEST(GltfLines, WhatCannotBeDrawnIsCountedAndTheRestIsKept)
{
  GltfBuilder builder = triangle_scene();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const int positions =
      builder.accessor(std::vector<float>{0, 0, 0, 0, 0, 0, 1, 0, 0, 2, nan, 0, 5, 5, 5}, Float32, "VEC3");
  const auto add = [&](const char *name, int mode, const std::vector<std::uint16_t> &indices) {
    const int accessor = builder.accessor(indices, Uint16, "SCALAR");
    builder.node(
        {{"mesh",
          builder.mesh({{"attributes", {{"POSITION", positions}}}, {"mode", mode}, {"indices", accessor}}, name)}});
  };
  add("list", 1, {0, 1, 1, 2, 2, 3, 2, 9, 4});
  add("points", 0, {0, 3, 9});
  add("short", 3, {2});
  add("odd", 9, {0, 1, 2});
  const Scene scene = import(builder);
  EXPECT_EQ(scene.objects().size(), 3U);
  EXPECT_WARNING(scene, "mesh 'list': line left out: it has no length");
  EXPECT_WARNING(scene, "mesh 'list': line left out: a position is not finite or beyond 1e12 m");
  EXPECT_WARNING(scene, "mesh 'list': line left out: a vertex index is out of range");
  EXPECT_WARNING(scene, "mesh 'list' and 1 other: vertex left over at the end: it makes no line (2 times)");
  EXPECT_WARNING(scene, "mesh 'points': point left out: a position is not finite or beyond 1e12 m");
  EXPECT_WARNING(scene, "mesh 'points': point left out: a vertex index is out of range");
  EXPECT_WARNING(scene, "mesh 'odd': primitive left out: mode: 9 is unknown");
  for (const auto &[handle, mesh] : scene.meshes()) {
    EXPECT_EQ(mesh.indices.size() / index_count_of(mesh.topology), 1U) << mesh.name;
  }
}

/** The material of a line in a file whose material is \a material. */
scene::Material line_material(json material, bool has_normals, bool has_tangents = false)
{
  GltfBuilder builder = triangle_scene();
  json attributes = {{"POSITION", builder.positions({0, 0, 0, 1, 0, 0})}};
  if (has_normals) {
    attributes["NORMAL"] = builder.accessor(std::vector<float>{0, 1, 0, 0, 1, 0}, Float32, "VEC3");
  }
  if (has_tangents) {
    attributes["TANGENT"] = builder.accessor(std::vector<float>{1, 0, 0, 1, 1, 0, 0, 1}, Float32, "VEC4");
  }
  builder.append("materials", std::move(material));
  builder.node({{"mesh", builder.mesh({{"attributes", attributes}, {"mode", 1}, {"material", 0}})}});
  const Scene scene = import(builder);
  for (const auto &[handle, mesh] : scene.meshes()) {
    if (mesh.topology == Topology::Lines) {
      return scene.material_of(mesh);
    }
  }
  ADD_FAILURE() << "there is no line";
  return {};
}

TEST(GltfLines, WithoutNormalsAreUnlitAndTheSumOfBaseColorAndEmission)
{
  const json source = {{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.25, 0, 1}}}},
                       {"emissiveFactor", {0.25, 0, 0.125}}};
  const scene::Material without = line_material(source, false);
  EXPECT_TRUE(without.is_unlit);
  EXPECT_EQ(without.base_color, glm::vec3(0.75F, 0.25F, 0.125F));
  const scene::Material with = line_material(source, true);
  EXPECT_FALSE(with.is_unlit);
  EXPECT_EQ(with.base_color, glm::vec3(0.5F, 0.25F, 0.0F));
}

TEST(GltfLines, WithoutTangentsHaveNoAnisotropy)
{
  const json source = {{"extensions", {{"KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}}}}}};
  EXPECT_EQ(line_material(source, true).anisotropy, 0.0F);
  EXPECT_FALSE(line_material(source, true).is_unlit);
  EXPECT_EQ(line_material(source, true, true).anisotropy, 0.5F);
}

TEST(GltfLines, ReadBackFromAnExportedFile)
{
  GltfBuilder builder = triangle_scene();
  const json attributes = {{"POSITION", builder.positions({0, 0, 0, 1, 0, 0, 1, 1, 0})}};
  for (const int mode : {0, 2}) {
    builder.node({{"mesh", builder.mesh({{"attributes", attributes}, {"mode", mode}})}});
  }
  const Scene scene = import(builder);
  const TemporaryFolder folder;
  gltf::export_gltf(scene, folder.path() / "copy.glb");
  const Scene copy = gltf::import_gltf(folder.path() / "copy.glb");
  expect_valid(copy);
  ASSERT_EQ(copy.meshes().size(), 3U);
  for (std::size_t i = 0; i < 3; i++) {
    EXPECT_EQ(nth(copy.meshes(), i).topology, nth(scene.meshes(), i).topology);
    EXPECT_EQ(nth(copy.meshes(), i).indices, nth(scene.meshes(), i).indices);
    EXPECT_EQ(copy.material_of(nth(copy.meshes(), i)).is_unlit, i > 0);
  }
}

}  // namespace
}  // namespace gnomon::test
