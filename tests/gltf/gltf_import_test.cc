// SPDX-License-Identifier: MIT
#include "gltf/gltf_check.hh"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include <array>
#include <numbers>

namespace gnomon::test {
namespace {

using scene::AlphaMode;
using scene::AreaShape;
using scene::CameraKind;
using scene::LampKind;
using scene::Material;
using scene::Mesh;
using scene::PlacedCamera;
using scene::PlacedLamp;
using scene::Scene;

constexpr double pi = std::numbers::pi;

void expect_near(const glm::vec3 &value, const glm::vec3 &expected, float tolerance = 1e-6F)
{
  EXPECT_LE(glm::length(value - expected), tolerance) << value.x << ' ' << value.y << ' ' << value.z << " is not "
                                                      << expected.x << ' ' << expected.y << ' ' << expected.z;
}

/** The corners of all triangles, in order. */
std::vector<glm::vec3> corners(const Mesh &mesh)
{
  std::vector<glm::vec3> result;
  for (const std::uint32_t index : mesh.indices) {
    result.push_back(mesh.positions[index]);
  }
  return result;
}

glm::vec3 face_normal(const Mesh &mesh, std::size_t triangle)
{
  const std::vector<glm::vec3> c = corners(mesh);
  return glm::normalize(glm::cross(c[3 * triangle + 1] - c[3 * triangle], c[3 * triangle + 2] - c[3 * triangle]));
}

/** Imports a scene whose only primitive is \a primitive. \return its mesh. */
Mesh import_mesh(GltfBuilder &builder, const json &primitive)
{
  builder.node({{"mesh", builder.mesh(primitive)}});
  const Scene scene = import(builder);
  EXPECT_EQ(scene.meshes().size(), 1U);
  return nth(scene.meshes(), 0);
}

// ---- Containers ----

TEST(GltfImport, GltfAndGlbGiveTheSameScene)
{
  const GltfBuilder builder = triangle_scene();
  const Scene text = import_text(builder.gltf());
  const Scene binary = import_text(builder.glb(), "scene.glb");
  ASSERT_EQ(text.meshes().size(), 1U);
  ASSERT_EQ(binary.meshes().size(), 1U);
  EXPECT_EQ(nth(text.meshes(), 0).positions, nth(binary.meshes(), 0).positions);
  EXPECT_EQ(object_name(text, 0), "thing");
  EXPECT_EQ(object_name(binary, 0), "thing");
}

TEST(GltfImport, ReadsABufferBesideTheFile)
{
  GltfBuilder builder = triangle_scene();
  const TemporaryFolder folder;
  // A file longer than byteLength is valid. A space in a URI is written as %20.
  (void)folder.write("the data.bin", std::string(builder.bytes.begin(), builder.bytes.end()) + "tail");
  builder.document["buffers"] = {{{"byteLength", builder.bytes.size()}, {"uri", "the%20data.bin"}}};
  const Scene scene = gltf::import_gltf(folder.write("scene.gltf", builder.gltf()));
  expect_valid(scene);
  EXPECT_EQ(corners(nth(scene.meshes(), 0))[1], glm::vec3(1, 0, 0));
}

TEST(GltfImport, KeepsThePathAsGiven)
{
  const TemporaryFolder folder;
  const std::filesystem::path path = folder.write("scene.gltf", triangle_scene().gltf());
  EXPECT_EQ(gltf::import_gltf(path).path, path.string());
}

TEST(GltfImport, UnusedImagesAreNotRead)
{
  GltfBuilder builder = triangle_scene();
  builder.document["images"] = {
      {{"uri", "missing.png"}}, {{"uri", "data:image/webp;base64,AAAA"}}, {{"bufferView", 99}}, json::object()};
  builder.document["textures"] = {{{"source", 77}}};
  EXPECT_EQ(import(builder).objects().size(), 1U);
}

// ---- Nodes ----

TEST(GltfNodes, WorldIsTheProductDownTheTree)
{
  GltfBuilder builder = triangle_scene();
  const double s = std::sqrt(0.5);
  json &nodes = builder.document["nodes"];
  nodes[0].update({{"translation", {0, 3, 0}}, {"scale", {2, 2, 2}}});
  nodes.push_back({{"rotation", {0, 0, s, s}}, {"children", {0}}});
  nodes.push_back({{"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 20, 30, 1}}, {"children", {1}}});
  builder.document["scenes"] = {{{"nodes", {2}}}};
  const Scene scene = import(builder);
  ASSERT_EQ(scene.objects().size(), 1U);
  // (1, 0, 0) is doubled, moved up by 3, rotated by 90 degrees about +Z, and translated.
  expect_near(glm::vec3(scene.objects()[0].world_from_object * glm::vec4(1, 0, 0, 1)), {10 - 3, 20 + 2, 30}, 1e-5F);
}

TEST(GltfNodes, OrderIsTranslateRotateScale)
{
  GltfBuilder builder = triangle_scene();
  const glm::quat rotation = glm::angleAxis(0.9F, glm::normalize(glm::vec3(1, -2, 0.5F)));
  builder.document["nodes"][0].update({{"translation", {1, 2, 3}},
                                       {"rotation", {rotation.x, rotation.y, rotation.z, rotation.w}},
                                       {"scale", {2, -3, 0.25}}});
  const glm::mat4 expected =
      glm::translate(glm::mat4(1), {1, 2, 3}) * glm::mat4_cast(rotation) * glm::scale(glm::mat4(1), {2, -3, 0.25F});
  const Scene scene = import(builder);
  for (int column = 0; column < 4; column++) {
    expect_near(glm::vec3(scene.objects().at(0).world_from_object[column]), glm::vec3(expected[column]), 1e-5F);
  }
}

TEST(GltfNodes, ProductsAreInDouble)
{
  // 16777217 is not a float. In single precision the child's translation back would leave 0 or 2.
  GltfBuilder builder = triangle_scene();
  builder.document["nodes"][0]["translation"] = {-16777216, 0, 0};
  builder.append("nodes", {{"translation", {16777217, 0, 0}}, {"children", {0}}});
  builder.document["scenes"] = {{{"nodes", {1}}}};
  EXPECT_EQ(import(builder).objects().at(0).world_from_object[3].x, 1.0F);
}

TEST(GltfNodes, SharedMeshIsOneMeshOfManyObjects)
{
  GltfBuilder builder = triangle_scene();
  builder.node({{"name", "other"}, {"mesh", 0}, {"translation", {5, 0, 0}}});
  const Scene scene = import(builder);
  EXPECT_EQ(scene.meshes().size(), 1U);
  ASSERT_EQ(scene.objects().size(), 2U);
  EXPECT_EQ(scene.objects()[0].mesh, scene.objects()[1].mesh);
  EXPECT_EQ(object_name(scene, 1), "other");
}

TEST(GltfNodes, EachPrimitiveIsAnObject)
{
  GltfBuilder builder;
  const int positions = builder.positions(triangle_positions);
  const json primitive = {{"attributes", {{"POSITION", positions}}}};
  builder.append("meshes", {{"name", "pair"}, {"primitives", {primitive, primitive}}});
  builder.node({{"name", "node"}, {"mesh", 0}});
  const Scene scene = import(builder);
  ASSERT_EQ(scene.objects().size(), 2U);
  EXPECT_EQ(nth(scene.meshes(), 0).name, "pair[0]");
  EXPECT_EQ(nth(scene.meshes(), 1).name, "pair[1]");
}

TEST(GltfNodes, OnlyTheDefaultSceneIsImported)
{
  GltfBuilder builder = triangle_scene();
  builder.append("nodes", {{"name", "second"}, {"mesh", 0}});
  builder.document["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  builder.document["scene"] = 1;
  EXPECT_EQ(object_name(import(builder), 0), "second");
  builder.document.erase("scene");
  EXPECT_EQ(object_name(import(builder), 0), "thing");
  builder.document.erase("scenes");
  EXPECT_EQ(import(builder).objects().size(), 2U);
}

TEST(GltfNodes, DepthOfAHundredThousandIsSupported)
{
  GltfBuilder builder = triangle_scene();
  constexpr int depth = 100000;
  json &nodes = builder.document["nodes"];
  for (int i = 1; i <= depth; i++) {
    nodes.push_back({{"children", {i - 1}}, {"translation", {0, 1, 0}}});
  }
  builder.document["scenes"] = {{{"nodes", {depth}}}};
  EXPECT_EQ(import(builder).objects().at(0).world_from_object[3].y, float(depth));
}

TEST(GltfNodes, SingularAndMirroredObjectsAreKept)
{
  GltfBuilder builder = triangle_scene();
  builder.document["nodes"][0]["scale"] = {-1, 1, 0};
  const Scene scene = import(builder);
  EXPECT_EQ(scene.objects().at(0).world_from_object[0].x, -1.0F);
  EXPECT_EQ(scene.objects().at(0).world_from_object[2], glm::dvec4(0));
}

TEST(GltfNodes, PerspectiveMatrixLosesItsLastRow)
{
  GltfBuilder builder = triangle_scene();
  builder.document["nodes"][0]["matrix"] = {1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2};
  EXPECT_WARNING(import(builder), "node 'thing': the last row of its matrix");
}

TEST(GltfNodes, ZeroRotationIsNamed)
{
  GltfBuilder builder = triangle_scene();
  builder.document["nodes"][0]["rotation"] = {0, 0, 0, 0};
  EXPECT_WARNING(import(builder), "node 'thing': its rotation has no length");
}

TEST(GltfNodes, MatrixOutOfFloatIsLeftOut)
{
  GltfBuilder builder = triangle_scene();
  builder.node({{"name", "far"}, {"mesh", 0}, {"translation", {1e300, 0, 0}}});
  builder.node({{"name", "farther"}, {"mesh", 0}, {"scale", {1e13, 1, 1}}});
  // The product with its parent's matrix would be in range.
  const int large = builder.append("nodes", {{"name", "large"}, {"mesh", 0}, {"scale", {1e13, 1, 1}}});
  builder.node({{"name", "small"}, {"scale", {1e-13, 1, 1}}, {"children", {large}}});
  const Scene scene = import(builder);
  EXPECT_EQ(scene.objects().size(), 1U);
  EXPECT_WARNING(scene,
                 "node 'far' and 2 others: left out: its own matrix or that to the world is not finite or reaches "
                 "beyond 1e12 m (3 times)");
}

TEST(GltfNodes, ObjectBeyondTheWorldIsLeftOut)
{
  GltfBuilder builder = triangle_scene();
  builder.append("accessors", {{"bufferView", builder.view(std::vector<float>{0, 0, 0, 1e10F, 0, 0, 0, 1e10F, 0})},
                               {"componentType", 5126},
                               {"count", 3},
                               {"type", "VEC3"}});
  const int mesh = builder.mesh({{"attributes", {{"POSITION", 1}}}});
  builder.node({{"name", "huge"}, {"mesh", mesh}, {"scale", {1e10, 1, 1}}});
  const Scene scene = import(builder);
  EXPECT_EQ(scene.objects().size(), 1U);
  EXPECT_WARNING(scene, "node 'huge': object left out: it reaches beyond");
}

// ---- Geometry ----

TEST(GltfImport, ListKeepsWindingAndOrder)
{
  GltfBuilder builder;
  const Mesh mesh = import_mesh(builder, {{"attributes", {{"POSITION", builder.positions(triangle_positions)}}}});
  EXPECT_EQ(corners(mesh), (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.normals, std::vector<glm::vec3>(3, glm::vec3(0, 0, 1)));
  EXPECT_EQ(mesh.bounds.min, glm::vec3(0));
  EXPECT_EQ(mesh.bounds.max, glm::vec3(1, 1, 0));
}

TEST(GltfImport, StripKeepsWinding)
{
  // A zigzag in the plane z = 0: every triangle must face +Z.
  GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0});
  const Mesh mesh = import_mesh(builder, {{"attributes", {{"POSITION", positions}}}, {"mode", 5}});
  ASSERT_EQ(mesh.indices.size(), 12U);
  for (std::size_t i = 0; i < 4; i++) {
    expect_near(face_normal(mesh, i), {0, 0, 1});
  }
}

TEST(GltfImport, FanKeepsWinding)
{
  GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, -1, 1, 0});
  const Mesh mesh = import_mesh(builder, {{"attributes", {{"POSITION", positions}}}, {"mode", 6}});
  ASSERT_EQ(mesh.indices.size(), 9U);
  for (std::size_t i = 0; i < 3; i++) {
    expect_near(face_normal(mesh, i), {0, 0, 1});
  }
}

TEST(GltfImport, StripStitchesAreDroppedSilently)
{
  GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 0, 0, 6, 0, 0, 5, 1, 0});
  const int indices = builder.accessor(std::vector<std::uint16_t>{0, 1, 2, 2, 3, 3, 4, 5}, Uint16, "SCALAR");
  const json primitive = {{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"mode", 5}};
  builder.node({{"mesh", builder.mesh(primitive)}});
  const Scene scene = import(builder);
  ASSERT_EQ(nth(scene.meshes(), 0).indices.size(), 6U);
  EXPECT_NO_WARNING(scene, "triangle");
}

template <typename Index>
void expect_indexed(Component component)
{
  GltfBuilder builder;
  const int positions = builder.positions({9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int indices = builder.accessor(std::vector<Index>{1, 2, 3}, component, "SCALAR");
  const Mesh mesh = import_mesh(builder, {{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  EXPECT_EQ(corners(mesh), (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(GltfImport, IndicesOfEveryWidth)
{
  expect_indexed<std::uint8_t>(Uint8);
  expect_indexed<std::uint16_t>(Uint16);
  expect_indexed<std::uint32_t>(Uint32);
}

TEST(GltfImport, SharedVerticesStaySharedAndUnusedOnesGo)
{
  GltfBuilder builder;
  const int positions = builder.positions({9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
  const int normals =
      builder.accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, Float32, "VEC3");
  const int indices = builder.accessor(std::vector<std::uint8_t>{1, 2, 3, 3, 2, 4}, Uint8, "SCALAR");
  const Mesh mesh =
      import_mesh(builder, {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}, {"indices", indices}});
  EXPECT_EQ(mesh.positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
  EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3}));
}

TEST(GltfImport, MissingNormalsAreFlat)
{
  // Two triangles share the ridge of a roof. A shared vertex could not have both normals.
  GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, 0, 0, 1, 1, 1, 0, -1, 1, 0});
  const int indices = builder.accessor(std::vector<std::uint8_t>{0, 2, 1, 0, 1, 3}, Uint8, "SCALAR");
  const Mesh mesh = import_mesh(builder, {{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  ASSERT_EQ(mesh.positions.size(), 6U);
  for (std::size_t i = 0; i < 6; i++) {
    expect_near(mesh.normals[mesh.indices[i]], face_normal(mesh, i / 3));
  }
}

TEST(GltfImport, InvalidNormalsAreReplaced)
{
  GltfBuilder builder;
  const float nan = std::nanf("");
  const int positions = builder.positions(triangle_positions);
  const int normals = builder.accessor(std::vector<float>{0, 0, 0, nan, 0, 0, 0, 3, 4}, Float32, "VEC3");
  builder.node({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}})}});
  const Scene scene = import(builder);
  expect_near(nth(scene.meshes(), 0).normals[0], {0, 0, 1});
  expect_near(nth(scene.meshes(), 0).normals[1], {0, 0, 1});
  expect_near(nth(scene.meshes(), 0).normals[2], {0, 0.6F, 0.8F});
  EXPECT_WARNING(scene, "mesh 'mesh': normal replaced by that of a face: it was zero or not finite (2 times)");
}

TEST(GltfImport, TinyAndHugeNormalsHaveADirection)
{
  GltfBuilder builder;
  const int positions = builder.positions(triangle_positions);
  const int normals =
      builder.accessor(std::vector<float>{0, 1e-40F, 0, 3e38F, 0, 3e38F, 0, 0, -1e-20F}, Float32, "VEC3");
  const Mesh mesh = import_mesh(builder, {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}});
  expect_near(mesh.normals[0], {0, 1, 0});
  expect_near(mesh.normals[1], {std::sqrt(0.5F), 0, std::sqrt(0.5F)});
  expect_near(mesh.normals[2], {0, 0, -1});
}

TEST(GltfImport, TinyTrianglesHaveNormals)
{
  GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, 1e-30F, 0, 0, 0, 1e-30F, 0});
  const Mesh mesh = import_mesh(builder, {{"attributes", {{"POSITION", positions}}}});
  expect_near(mesh.normals.at(0), {0, 0, 1});
}

TEST(GltfImport, UnreadableNormalsAreReplaced)
{
  GltfBuilder builder;
  const int positions = builder.positions(triangle_positions);
  const int normals = builder.accessor(std::vector<float>{0, 0, 1}, Float32, "VEC3");
  builder.node({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}})}});
  const Scene scene = import(builder);
  EXPECT_EQ(nth(scene.meshes(), 0).normals[0], glm::vec3(0, 0, 1));
  EXPECT_WARNING(scene, "mesh 'mesh': flat normals made instead: NORMAL: count differs");
}

template <typename T>
glm::vec3 imported_corner(Component component, bool is_normalized, const std::array<T, 3> &corner)
{
  GltfBuilder builder;
  const std::vector<T> values{0, 0, 0, corner[0], corner[1], corner[2], 0, T(100), 0};
  const int positions = builder.accessor(values, component, "VEC3", {{"normalized", is_normalized}});
  return corners(import_mesh(builder, {{"attributes", {{"POSITION", positions}}}}))[1];
}

TEST(GltfAccessor, QuantisedPositionsOfEveryType)
{
  EXPECT_EQ(imported_corner<std::int8_t>(Int8, false, {-128, 127, 1}), glm::vec3(-128, 127, 1));
  EXPECT_EQ(imported_corner<std::uint8_t>(Uint8, false, {255, 127, 1}), glm::vec3(255, 127, 1));
  EXPECT_EQ(imported_corner<std::int16_t>(Int16, false, {-32768, 32767, 1}), glm::vec3(-32768, 32767, 1));
  EXPECT_EQ(imported_corner<std::uint16_t>(Uint16, false, {65535, 7, 1}), glm::vec3(65535, 7, 1));
  EXPECT_EQ(imported_corner<std::uint32_t>(Uint32, false, {1U << 31U, 7, 1}), glm::vec3(2147483648.0F, 7, 1));
  EXPECT_EQ(imported_corner<float>(Float32, false, {0.5F, -7, 1}), glm::vec3(0.5F, -7, 1));
}

TEST(GltfAccessor, NormalisedIntegersFollowTheSpecification)
{
  EXPECT_EQ(imported_corner<std::int8_t>(Int8, true, {-128, 127, -127}), glm::vec3(-1, 1, -1));
  EXPECT_EQ(imported_corner<std::uint8_t>(Uint8, true, {255, 51, 0}), glm::vec3(1, 0.2F, 0));
  EXPECT_EQ(imported_corner<std::int16_t>(Int16, true, {-32768, 32767, 0}), glm::vec3(-1, 1, 0));
  EXPECT_EQ(imported_corner<std::uint16_t>(Uint16, true, {65535, 13107, 0}), glm::vec3(1, 0.2F, 0));
}

TEST(GltfAccessor, InterleavedVertices)
{
  GltfBuilder builder;
  const int view = builder.view(std::vector<float>{0, 0, 0, 0, 0, 2, 1, 0, 0, 0, 0, 2, 0, 1, 0, 0, 0, 2}, 24);
  const json common = {{"bufferView", view}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}};
  json normals = common;
  normals["byteOffset"] = 12;
  builder.append("accessors", common);
  builder.append("accessors", normals);
  const Mesh mesh = import_mesh(builder, {{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}});
  EXPECT_EQ(mesh.positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.normals, std::vector<glm::vec3>(3, glm::vec3(0, 0, 1)));
}

TEST(GltfAccessor, SparseReplacesElements)
{
  GltfBuilder builder;
  const int indices = builder.view(std::vector<std::uint16_t>{1, 2});
  const int values = builder.view(std::vector<float>{7, 0, 0, 0, 8, 0});
  const json sparse = {{"count", 2},
                       {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                       {"values", {{"bufferView", values}}}};
  const int positions = builder.accessor(triangle_positions, Float32, "VEC3", {{"sparse", sparse}});
  const Mesh mesh = import_mesh(builder, {{"attributes", {{"POSITION", positions}}}});
  EXPECT_EQ(corners(mesh), (std::vector<glm::vec3>{{0, 0, 0}, {7, 0, 0}, {0, 8, 0}}));
}

TEST(GltfAccessor, SparseWithoutBufferViewStartsFromZeros)
{
  GltfBuilder builder;
  const int indices = builder.view(std::vector<std::uint8_t>{1, 2});
  const int values = builder.view(std::vector<float>{7, 0, 0, 0, 8, 0});
  builder.append("accessors", {{"componentType", 5126},
                               {"count", 3},
                               {"type", "VEC3"},
                               {"sparse",
                                {{"count", 2},
                                 {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                 {"values", {{"bufferView", values}}}}}});
  const Mesh mesh = import_mesh(builder, {{"attributes", {{"POSITION", 0}}}});
  EXPECT_EQ(corners(mesh), (std::vector<glm::vec3>{{0, 0, 0}, {7, 0, 0}, {0, 8, 0}}));
}

TEST(GltfAccessor, SparseIndexAccessorWithoutBufferView)
{
  // Some loaders refuse this file, though glTF allows it.
  GltfBuilder builder;
  const int positions = builder.positions(triangle_positions);
  const int places = builder.view(std::vector<std::uint8_t>{1, 2});
  const int values = builder.view(std::vector<std::uint16_t>{1, 2});
  const int indices = builder.append("accessors", {{"componentType", 5123},
                                                   {"count", 3},
                                                   {"type", "SCALAR"},
                                                   {"sparse",
                                                    {{"count", 2},
                                                     {"indices", {{"bufferView", places}, {"componentType", 5121}}},
                                                     {"values", {{"bufferView", values}}}}}});
  const Mesh mesh = import_mesh(builder, {{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  EXPECT_EQ(corners(mesh), (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(GltfImport, LeftOverVerticesAreCounted)
{
  GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5, 6, 6, 6});
  builder.node({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}}}})}});
  const Scene scene = import(builder);
  EXPECT_EQ(nth(scene.meshes(), 0).indices.size(), 3U);
  EXPECT_WARNING(scene, "mesh 'mesh': vertex left over at the end: it makes no triangle (2 times)");
}

// ---- Flat facets ----

/** Two triangles of a quad whose fourth corner is \a lift above the plane of the others. All corners have \a normal. */
Mesh import_quad(float lift, const glm::vec3 &normal)
{
  GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, lift});
  std::vector<float> normals;
  for (int i = 0; i < 4; i++) {
    normals.insert(normals.end(), {normal.x, normal.y, normal.z});
  }
  const int normal_accessor = builder.accessor(normals, Component::Float32, "VEC3");
  const int indices = builder.accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, Component::Uint16, "SCALAR");
  return import_mesh(builder,
                     {{"attributes", {{"POSITION", positions}, {"NORMAL", normal_accessor}}}, {"indices", indices}});
}

/** The mean of the triangles' normals, which exporters write for the polygon. */
glm::vec3 quad_normal(float lift)
{
  const glm::vec3 diagonal = glm::vec3(0, 1, lift) - glm::vec3(1, 0, 0);
  return glm::normalize(glm::cross(glm::vec3(1, 1, 0), diagonal));
}

TEST(GltfImport, TrianglesOfABentFlatQuadGetTheirOwnNormals)
{
  const Mesh mesh = import_quad(0.3F, quad_normal(0.3F));
  ASSERT_EQ(mesh.indices.size(), 6U);
  for (std::size_t triangle = 0; triangle < 2; triangle++) {
    for (std::size_t corner = 0; corner < 3; corner++) {
      expect_near(mesh.normals[mesh.indices[3 * triangle + corner]], face_normal(mesh, triangle));
    }
  }
  EXPECT_EQ(corners(mesh)[5], glm::vec3(0, 1, 0.3F)) << "and stay where they are";
}

TEST(GltfImport, APlaneQuadKeepsItsVertices)
{
  const Mesh mesh = import_quad(0.0F, {0, 0, 1});
  EXPECT_EQ(mesh.positions.size(), 4U);
  EXPECT_EQ(mesh.normals[0], glm::vec3(0, 0, 1));
}

TEST(GltfImport, IntentionalNormalsAreKept)
{
  // A blade of grass with the normal of the ground below it.
  const Mesh mesh = import_quad(0.3F, {0, 1, 0});
  EXPECT_EQ(mesh.positions.size(), 4U);
  for (const glm::vec3 &normal : mesh.normals) {
    EXPECT_EQ(normal, glm::vec3(0, 1, 0));
  }
}

// ---- Materials ----

/** Imports a simple scene with this material. \return the material and the scene, which has its warnings. */
std::pair<Material, Scene> import_material(json material)
{
  GltfBuilder builder = triangle_scene();
  material["name"] = "paint";
  builder.append("materials", std::move(material));
  builder.document["meshes"][0]["primitives"][0]["material"] = 0;
  Scene scene = import(builder);
  return {nth(scene.materials(), 0), scene};
}

TEST(GltfMaterial, AbsentIsTheDefaultOfGltf)
{
  const Scene scene = import(triangle_scene());
  ASSERT_EQ(scene.materials().size(), 1U);
  const Material &material = nth(scene.materials(), 0);
  EXPECT_EQ(material.base_color, glm::vec3(1));
  EXPECT_EQ(material.metallic, 1);
  EXPECT_EQ(material.roughness, 1);
  EXPECT_EQ(material.specular, 1);
  EXPECT_EQ(material.emissive, glm::vec3(0));
  EXPECT_FALSE(material.is_double_sided);
}

TEST(GltfMaterial, FactorsAreRead)
{
  const auto [material, scene] =
      import_material({{"pbrMetallicRoughness",
                        {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.6}}},
                       {"emissiveFactor", {0.25, 0.5, 1}},
                       {"doubleSided", true},
                       {"alphaCutoff", 0.75},
                       {"extensions",
                        {{"KHR_materials_specular", {{"specularFactor", 0.7}, {"specularColorFactor", {0, 1, 2}}}},
                         {"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}}});
  EXPECT_EQ(material.name, "paint");
  EXPECT_EQ(material.base_color, glm::vec3(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(material.alpha, 0.4F);
  EXPECT_EQ(material.metallic, 0.5F);
  EXPECT_EQ(material.roughness, 0.6F);
  EXPECT_EQ(material.specular, 0.7F);
  EXPECT_EQ(material.specular_color, glm::vec3(0, 1, 2));
  EXPECT_EQ(material.emissive, glm::vec3(2, 4, 8));
  EXPECT_EQ(material.alpha_cutoff, 0.75F);
  EXPECT_TRUE(material.is_double_sided);
  EXPECT_NO_WARNING(scene, "paint");
}

TEST(GltfMaterial, ACutoffAboveOneCutsOutOpaqueMaterialsToo)
{
  const auto [material, scene] = import_material({{"alphaMode", "MASK"}, {"alphaCutoff", 1.5}});
  EXPECT_GT(material.alpha_cutoff, material.alpha);
  EXPECT_NO_WARNING(scene, "paint");
}

TEST(GltfMaterial, RefractionScalesTheReflection)
{
  // An index of 1.5 reflects 0.04, and 2 reflects 1/9.
  const auto with_ior = [](double ior) {
    return import_material({{"extensions", {{"KHR_materials_ior", {{"ior", ior}}}}}}).first.specular_color.x;
  };
  EXPECT_FLOAT_EQ(with_ior(1.5), 1.0F);
  EXPECT_FLOAT_EQ(with_ior(2.0), float(1.0 / 9.0 / 0.04));
  EXPECT_FLOAT_EQ(with_ior(1.0), 0.0F);
  EXPECT_FLOAT_EQ(with_ior(0.0), 25.0F);
}

TEST(GltfMaterial, FactorsOutOfRangeAreClampedAndNamed)
{
  const auto [material, scene] =
      import_material({{"pbrMetallicRoughness", {{"roughnessFactor", -2}, {"metallicFactor", 1e300}}}});
  EXPECT_EQ(material.roughness, 0);
  EXPECT_EQ(material.metallic, 1);
  EXPECT_WARNING(scene, "material 'paint': roughnessFactor is -2, clamped to 0");
  EXPECT_WARNING(scene, "material 'paint': metallicFactor is 1e+300, clamped to 1");
}

TEST(GltfMaterial, EmissionStaysFinite)
{
  const auto [material, scene] =
      import_material({{"emissiveFactor", {1, 1, 1}},
                       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 1e300}}}}}});
  EXPECT_EQ(material.emissive, glm::vec3(float(scene::light_max)));
  EXPECT_WARNING(scene, "emissiveStrength is 1e+300");
}

TEST(GltfMaterial, LargeWholeNumbersAreNotTruncated)
{
  // The lower 32 bits are 1.
  const auto [material, scene] = import_material(
      {{"extensions",
        {{"KHR_materials_specular", {{"specularFactor", 0.5}, {"specularColorFactor", {4294967297, 0, 0}}}}}}});
  EXPECT_EQ(material.specular_color.x, 4294967297.0F);
}

TEST(GltfMaterial, AlphaModesAreReadAndNamed)
{
  const auto [mask, mask_scene] = import_material({{"alphaMode", "MASK"}});
  EXPECT_EQ(mask.alpha_mode, AlphaMode::Mask);
  EXPECT_NO_WARNING(mask_scene, "alphaMode");
  const auto [blend, blend_scene] = import_material({{"alphaMode", "BLEND"}});
  EXPECT_EQ(blend.alpha_mode, AlphaMode::Blend);
  EXPECT_NO_WARNING(blend_scene, "alphaMode");
  const auto [odd, odd_scene] = import_material({{"alphaMode", "ODD"}});
  EXPECT_EQ(odd.alpha_mode, AlphaMode::Opaque);
  EXPECT_WARNING(odd_scene, "alphaMode 'ODD' is unknown");
}

TEST(GltfMaterial, MissingTexturesHaveStandInsThatAreNamed)
{
  const json slot = {{"index", 0}};
  const auto [material, scene] = import_material(
      {{"pbrMetallicRoughness", {{"baseColorTexture", slot}, {"metallicRoughnessTexture", slot}}},
       {"normalTexture", {{"index", 0}, {"scale", 0.5}}},
       {"occlusionTexture", {{"index", 0}, {"strength", 0.25}}},
       {"emissiveTexture", slot},
       {"emissiveFactor", {1, 1, 1}},
       {"extensions", {{"KHR_materials_specular", {{"specularTexture", slot}, {"specularColorTexture", slot}}}}}});
  EXPECT_EQ(material.normal_scale, 0.5F);
  EXPECT_EQ(material.occlusion_strength, 0.25F);
  const auto stand_in = [&scene_ = scene](const scene::TextureSlot &of) {
    const std::vector<std::uint8_t> &texels = scene_.images()[scene_.textures()[of.texture].image].texels;
    return std::vector<int>(texels.begin(), texels.begin() + 4);
  };
  EXPECT_EQ(stand_in(material.base_color_texture), (std::vector{255, 0, 255, 255}));
  EXPECT_EQ(stand_in(material.metallic_roughness_texture), (std::vector{255, 255, 0, 255})) << "no metal";
  EXPECT_EQ(stand_in(material.normal_texture), (std::vector{128, 128, 255, 255}));
  EXPECT_EQ(stand_in(material.occlusion_texture), (std::vector{255, 255, 255, 255}));
  EXPECT_EQ(stand_in(material.emissive_texture), (std::vector{0, 0, 0, 255})) << "it must not shine all over";
  EXPECT_EQ(stand_in(material.specular_texture), (std::vector{255, 255, 255, 255}));
  EXPECT_EQ(stand_in(material.specular_color_texture), (std::vector{255, 255, 255, 255}));
  EXPECT_WARNING(scene,
                 "material 'paint': its metallicRoughnessTexture is drawn as no metal, of the factor's roughness: ");
  EXPECT_WARNING(scene, "material 'paint': its emissiveTexture is drawn as no emission: ");
}

TEST(GltfMaterial, UnlitIsRead)
{
  const auto [material, scene] = import_material({{"extensions", {{"KHR_materials_unlit", json::object()}}}});
  EXPECT_TRUE(material.is_unlit);
  EXPECT_NO_WARNING(scene, "unlit");
}

TEST(GltfMaterial, SpecularGlossinessIsConverted)
{
  const auto [material, scene] = import_material({{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}}},
                                                  {"extensions",
                                                   {{"KHR_materials_pbrSpecularGlossiness",
                                                     {{"diffuseFactor", {0.1, 0.2, 0.3, 0.4}},
                                                      {"specularFactor", {0.5, 0.04, 0}},
                                                      {"glossinessFactor", 0.75}}}}}});
  EXPECT_EQ(material.base_color, glm::vec3(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(material.alpha, 0.4F);
  EXPECT_EQ(material.metallic, 0.0F);
  EXPECT_EQ(material.roughness, 0.25F);
  EXPECT_EQ(material.specular_color, glm::vec3(12.5F, 1.0F, 0.0F)) << "in units of 4 %";
  EXPECT_NO_WARNING(scene, "material 'paint'");
}

TEST(GltfMaterial, CoatAndSheenAreRead)
{
  const auto [material, scene] = import_material(
      {{"extensions",
        {{"KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}, {"clearcoatRoughnessFactor", 2}}},
         {"KHR_materials_sheen", {{"sheenColorFactor", {0.1, 0.2, 0.3}}, {"sheenRoughnessFactor", 0.4}}}}}});
  EXPECT_TRUE(material.has_coat() && material.has_sheen());
  EXPECT_EQ(material.coat, 0.5F);
  EXPECT_EQ(material.coat_roughness, 1.0F);
  EXPECT_EQ(material.sheen_color, glm::vec3(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(material.sheen_roughness, 0.4F);
  EXPECT_WARNING(scene, "material 'paint': clearcoatRoughnessFactor is 2, clamped to 1");
  EXPECT_NO_WARNING(scene, "is not read");
}

TEST(GltfMaterial, AnisotropyIsReadAndItsTextureOnlyWithIt)
{
  const auto import_anisotropy = [](double strength) {
    return import_material({{"extensions",
                             {{"KHR_materials_anisotropy",
                               {{"anisotropyStrength", strength},
                                {"anisotropyRotation", 0.25},
                                {"anisotropyTexture", {{"index", 0}}}}}}}});
  };
  const auto [material, scene] = import_anisotropy(2);
  EXPECT_TRUE(material.has_anisotropy());
  EXPECT_EQ(material.anisotropy, 1.0F);
  EXPECT_EQ(material.anisotropy_rotation, 0.25F);
  EXPECT_WARNING(scene, "material 'paint': anisotropyStrength is 2, clamped to 1");
  EXPECT_WARNING(scene, "material 'paint': its anisotropyTexture is drawn as the factor alone: ");
  EXPECT_NO_WARNING(scene, "KHR_materials_anisotropy is not read");
  const auto [bare, bare_scene] = import_anisotropy(0);
  EXPECT_FALSE(bare.has_anisotropy() || bare.anisotropy_texture);
  EXPECT_NO_WARNING(bare_scene, "material 'paint'");
}

TEST(GltfMaterial, TexturesOfAbsentLayersAreNotRead)
{
  const json slot = {{"index", 0}};
  const auto import_coat = [&](double factor) {
    return import_material({{"extensions",
                             {{"KHR_materials_clearcoat",
                               {{"clearcoatFactor", factor},
                                {"clearcoatTexture", slot},
                                {"clearcoatRoughnessTexture", slot},
                                {"clearcoatNormalTexture", slot}}},
                              {"KHR_materials_sheen", {{"sheenColorTexture", slot}}}}}});
  };
  const auto [bare, bare_scene] = import_coat(0);
  EXPECT_FALSE(bare.coat_normal_texture);
  EXPECT_FALSE(bare.has_coat() || bare.coat_texture || bare.coat_roughness_texture || bare.sheen_color_texture);
  EXPECT_EQ(bare_scene.images().size(), 0U);
  EXPECT_NO_WARNING(bare_scene, "material 'paint'");
  const auto [coated, coated_scene] = import_coat(1);
  EXPECT_TRUE(coated.coat_texture && coated.coat_roughness_texture && !coated.sheen_color_texture);
  EXPECT_WARNING(coated_scene, "material 'paint': its clearcoatTexture is drawn as the factor alone: ");
  EXPECT_TRUE(coated.coat_normal_texture);
  EXPECT_WARNING(coated_scene,
                 "material 'paint': its clearcoatNormalTexture is drawn as a coat as smooth as the mesh: ");
}

TEST(GltfMaterial, ForeignModelsAreNamed)
{
  const auto [material, scene] = import_material(
      {{"extensions", {{"KHR_materials_iridescence", json::object()}, {"KHR_materials_dispersion", {{"a", {1, 2}}}}}}});
  EXPECT_WARNING(scene, "material 'paint': KHR_materials_iridescence is not read");
  EXPECT_WARNING(scene, "material 'paint': KHR_materials_dispersion is not read");
}

TEST(GltfMaterial, TransmissionAndVolumeAreRead)
{
  const json slot = {{"index", 0}};
  const auto import_glass = [&](const json &transmission, const json &volume, double ior) {
    return import_material({{"extensions",
                             {{"KHR_materials_transmission", transmission},
                              {"KHR_materials_volume", volume},
                              {"KHR_materials_ior", {{"ior", ior}}}}}});
  };
  const auto [glass, scene] = import_glass({{"transmissionFactor", 0.5}, {"transmissionTexture", slot}},
                                           {{"thicknessFactor", 0.25},
                                            {"thicknessTexture", slot},
                                            {"attenuationDistance", 3},
                                            {"attenuationColor", {0.5, 1, 0}}},
                                           2.0);
  EXPECT_TRUE(glass.has_transmission());
  EXPECT_EQ(glass.transmission, 0.5F);
  EXPECT_EQ(glass.thickness, 0.25F);
  EXPECT_EQ(glass.ior, 2.0F);
  EXPECT_EQ(glass.attenuation_distance, 3.0F);
  EXPECT_EQ(glass.attenuation_color, glm::vec3(0.5F, 1.0F, 0.0F));
  EXPECT_TRUE(glass.transmission_texture && glass.thickness_texture);
  EXPECT_NO_WARNING(scene, "KHR_materials");

  const auto [own, own_scene] = import_material({{"extensions",
                                                  {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                                                   {"KHR_materials_volume", {{"thicknessFactor", 0.25}}}}},
                                                 {"extras", {{"gnomon_thickness", 2.5}}}});
  EXPECT_EQ(own.thickness, 2.5F);

  const auto [odd, odd_scene] =
      import_glass({{"transmissionFactor", 2}},
                   {{"thicknessFactor", -1}, {"thicknessTexture", slot}, {"attenuationDistance", 0}}, 0.5);
  EXPECT_EQ(odd.transmission, 1.0F);
  EXPECT_EQ(odd.thickness, 0.0F);
  EXPECT_EQ(odd.ior, 1.0F);
  EXPECT_EQ(odd.attenuation_distance, 0.0F);
  EXPECT_FALSE(odd.thickness_texture) << "it has no effect";
  EXPECT_WARNING(odd_scene, "material 'paint': transmissionFactor is 2, clamped to 1");
  EXPECT_WARNING(odd_scene, "material 'paint': thicknessFactor is -1, clamped to 0");
  EXPECT_WARNING(odd_scene, "material 'paint': attenuationDistance is 0, not above 0; nothing is absorbed");
  EXPECT_WARNING(odd_scene, "material 'paint': ior is 0.5, clamped to 1");
  const auto [opaque, opaque_scene] = import_glass({{"transmissionTexture", slot}}, {{"thicknessTexture", slot}}, 0.0);
  EXPECT_FALSE(opaque.has_transmission() || opaque.transmission_texture || opaque.thickness_texture);
  EXPECT_EQ(opaque.ior, 1.5F) << "what reflects all light refracts none";
  EXPECT_EQ(opaque.specular_color, glm::vec3(25.0F));
}

TEST(GltfMaterial, AVariantReplacesTheMaterialsThatItMaps)
{
  GltfBuilder builder = triangle_scene();
  builder.append("materials", {{"name", "plain"}});
  builder.append("materials", {{"name", "red"}});
  json &primitive = builder.document["meshes"][0]["primitives"][0];
  primitive["material"] = 0;
  primitive["extensions"]["KHR_materials_variants"]["mappings"] = {{{"material", 1}, {"variants", {1, 2}}}};
  builder.document["extensions"]["KHR_materials_variants"]["variants"] = {
      {{"name", "day"}}, {{"name", "night"}}, {{"name", "dusk"}}};
  const auto material_of = [&](const std::string &variant) {
    const Scene scene = import_text(builder.gltf(), "scene.gltf", {.variant = variant});
    EXPECT_EQ(scene.materials().size(), 1U) << variant;
    return scene.material_of(nth(scene.meshes(), 0)).name;
  };
  EXPECT_EQ(material_of(""), "plain");
  EXPECT_EQ(material_of("day"), "plain") << "it maps nothing";
  EXPECT_EQ(material_of("night"), "red");
  EXPECT_EQ(material_of("dusk"), "red");
  try {
    static_cast<void>(import_text(builder.gltf(), "scene.gltf", {.variant = "noon"}));
    ADD_FAILURE() << "there is no such variant";
  }
  catch (const gltf::UnknownVariant &unknown) {
    EXPECT_NE(std::string(unknown.what()).find("has no variant 'noon'; it has 'day', 'night', 'dusk'"),
              std::string::npos)
        << unknown.what();
  }
}

TEST(GltfMaterial, UnusedOnesAreNeitherKeptNorNamed)
{
  GltfBuilder builder = triangle_scene();
  builder.append("materials", {{"name", "idle"}, {"alphaMode", "MASK"}});
  const Scene scene = import(builder);
  EXPECT_EQ(scene.materials().size(), 1U);
  EXPECT_NO_WARNING(scene, "idle");
}

// ---- Lamps ----

PlacedLamp import_lamp(json light, json extras = nullptr, json more = json::object())
{
  GltfBuilder builder = triangle_scene();
  builder.light(std::move(light), std::move(extras), std::move(more));
  const Scene scene = import(builder);
  EXPECT_EQ(scene.placed_lamps().size(), 1U);
  EXPECT_FALSE(scene.is_lamp_default);
  EXPECT_NO_WARNING(scene, "lamp 'lamp'");
  return scene.placed_lamps().at(0);
}

TEST(GltfLamp, ARangeOf0IsNamed)
{
  for (const char *type : {"point", "spot", "directional"}) {
    GltfBuilder builder = triangle_scene();
    builder.light({{"type", type}, {"range", 0}, {"spot", json::object()}}, nullptr, json::object());
    const Scene scene = import(builder);
    EXPECT_EQ(scene.placed_lamps().at(0).range, 0.0F);
    const std::string message = "lamp 'lamp': range is 0, and must be above 0; the lamp has no limit of its range";
    // A sun has no range.
    if (type == std::string("directional")) {
      EXPECT_NO_WARNING(scene, message);
    }
    else {
      EXPECT_WARNING(scene, message);
    }
  }
}

TEST(GltfLamp, PhotometricUnitsAreDividedBy683)
{
  const PlacedLamp sun = import_lamp({{"type", "directional"}, {"intensity", 1366}, {"color", {1, 0.5, 0.25}}});
  EXPECT_EQ(sun.kind, LampKind::Sun);
  EXPECT_FLOAT_EQ(sun.intensity, 2.0F);
  EXPECT_EQ(sun.color, glm::vec3(1, 0.5F, 0.25F));
  // A point lamp of 100 W as written by Blender.
  const PlacedLamp point = import_lamp({{"type", "point"}, {"intensity", 100 * 683 / (4 * pi)}, {"range", 12.5}});
  EXPECT_EQ(point.kind, LampKind::Point);
  EXPECT_FLOAT_EQ(point.intensity, float(100 / (4 * pi)));
  EXPECT_EQ(point.range, 12.5F);
  EXPECT_EQ(point.radius, 0);
}

TEST(GltfLamp, DefaultsAreThoseOfTheExtension)
{
  const PlacedLamp lamp = import_lamp({{"type", "spot"}, {"spot", json::object()}});
  EXPECT_EQ(lamp.color, glm::vec3(1));
  EXPECT_FLOAT_EQ(lamp.intensity, float(1 / 683.0));
  EXPECT_EQ(lamp.range, 0);
  EXPECT_FLOAT_EQ(lamp.spot_outer_angle, float(pi / 4));
  // Inner 0: the edge reaches the axis.
  EXPECT_FLOAT_EQ(lamp.spot_blend, 1.0F);
}

TEST(GltfLamp, BlendComesFromTheConesInCosines)
{
  const auto blend = [](double inner, double outer) {
    return import_lamp({{"type", "spot"}, {"spot", {{"innerConeAngle", inner}, {"outerConeAngle", outer}}}}).spot_blend;
  };
  EXPECT_NEAR(blend(0.3, 0.6), (std::cos(0.3) - std::cos(0.6)) / (1 - std::cos(0.6)), 1e-6);
  EXPECT_EQ(blend(0.5, 0.5), 0.0F);
  EXPECT_NEAR(blend(0, pi / 2), 1.0, 1e-6);
  // The limit for narrow cones is 1 - (inner / outer)², which float cosines cannot resolve.
  EXPECT_NEAR(blend(0.5e-9, 1e-9), 0.75, 1e-6);
}

TEST(GltfLamp, ExtrasOfPointSpotAndSun)
{
  const json spot = {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.42}, {"outerConeAngle", 0.6}}}};
  const PlacedLamp lamp =
      import_lamp(spot, {{"gnomon_radius", 0.25}, {"gnomon_spot_blend", 0.3}, {"someone_elses", {{"a", 1}}}});
  EXPECT_EQ(lamp.radius, 0.25F);
  EXPECT_EQ(lamp.spot_blend, 0.3F);
  EXPECT_EQ(lamp.spot_outer_angle, 0.6F);
  EXPECT_EQ(import_lamp({{"type", "point"}}, {{"gnomon_radius", 2}}).radius, 2.0F);
  EXPECT_EQ(import_lamp({{"type", "directional"}}, {{"gnomon_angle", 0.1}}).angle, 0.1F);
}

TEST(GltfLamp, ShadowExtrasAreAbsentOrRead)
{
  const json point = {{"type", "point"}};
  const scene::LampShadow none = import_lamp(point).shadow;
  EXPECT_FALSE(none.kind || none.size || none.exponent || none.bias || none.clip_start || none.clip_end ||
               none.filter_angle || none.esm_size || none.esm_format);
  // Blender writes whole numbers both as integers and as floats.
  const scene::LampShadow all = import_lamp(point, {{"gnomon_shadow", "esm"},
                                                    {"gnomon_shadow_size", 1024},
                                                    {"gnomon_exponent", 80},
                                                    {"gnomon_bias", 0.5},
                                                    {"gnomon_clip_start", 0.25},
                                                    {"gnomon_clip_end", 40.0},
                                                    {"gnomon_filter_radius", 45},
                                                    {"gnomon_esm_size", 512.0},
                                                    {"gnomon_esm_format", "16f"}})
                                    .shadow;
  EXPECT_EQ(all.kind, scene::ShadowKind::Esm);
  EXPECT_EQ(all.size, 1024);
  EXPECT_EQ(all.exponent, 80.0F);
  EXPECT_EQ(all.bias, 0.5F);
  EXPECT_EQ(all.clip_start, 0.25F);
  EXPECT_EQ(all.clip_end, 40.0F);
  ASSERT_TRUE(all.filter_angle);
  EXPECT_FLOAT_EQ(*all.filter_angle, float(pi / 4));
  EXPECT_EQ(all.esm_size, 512);
  EXPECT_EQ(all.esm_format, scene::EsmFormat::Half);
  const auto kind = [&](const char *word) { return import_lamp(point, {{"gnomon_shadow", word}}).shadow.kind; };
  EXPECT_EQ(kind("none"), scene::ShadowKind::None);
  EXPECT_EQ(kind("hard"), scene::ShadowKind::Hard);
  EXPECT_EQ(kind("pcf"), scene::ShadowKind::Pcf);
  EXPECT_EQ(import_lamp(point, {{"gnomon_esm_format", "32f"}}).shadow.esm_format, scene::EsmFormat::Float);
  EXPECT_EQ(import_lamp({{"type", "directional"}}, {{"gnomon_shadow", "pcf"}}).shadow.kind, scene::ShadowKind::Pcf);
}

TEST(GltfLamp, HemiIsADirectionalLightWithAnExtra)
{
  const PlacedLamp lamp = import_lamp({{"type", "directional"}, {"intensity", 683}}, {{"gnomon_lamp", "hemi"}});
  EXPECT_EQ(lamp.kind, LampKind::Hemi);
  EXPECT_FLOAT_EQ(lamp.intensity, 1.0F);
}

PlacedLamp import_area(const json &extras)
{
  GltfBuilder builder = triangle_scene();
  builder.node({{"name", "area"}, {"extras", extras}});
  const Scene scene = import(builder);
  EXPECT_EQ(scene.placed_lamps().size(), 1U);
  return scene.placed_lamps().at(0);
}

TEST(GltfLamp, AreaLampsAreReadFromExtras)
{
  const PlacedLamp lamp = import_area({{"gnomon_lamp", "area"},
                                       {"gnomon_shape", "rectangle"},
                                       {"gnomon_size_x", 2.5},
                                       {"gnomon_size_y", 0.75},
                                       {"gnomon_power", 120},
                                       {"gnomon_color", {1, 0.5, 0}}});
  EXPECT_EQ(lamp.name, "area");
  EXPECT_EQ(lamp.kind, LampKind::Area);
  EXPECT_EQ(lamp.area_shape, AreaShape::Rectangle);
  EXPECT_EQ(lamp.area_size_x, 2.5F);
  EXPECT_EQ(lamp.area_size_y, 0.75F);
  EXPECT_EQ(lamp.intensity, 120.0F);
  EXPECT_EQ(lamp.color, glm::vec3(1, 0.5F, 0));
}

TEST(GltfLamp, AreaShapes)
{
  const auto area = [](const char *shape) {
    return import_area({{"gnomon_lamp", "area"}, {"gnomon_shape", shape}, {"gnomon_size_x", 2}, {"gnomon_size_y", 3}});
  };
  EXPECT_EQ(area("square").area_shape, AreaShape::Rectangle);
  EXPECT_EQ(area("square").area_size_y, 2.0F);
  EXPECT_EQ(area("rectangle").area_size_y, 3.0F);
  EXPECT_EQ(area("disk").area_shape, AreaShape::Ellipse);
  EXPECT_EQ(area("disk").area_size_y, 2.0F);
  EXPECT_EQ(area("ellipse").area_shape, AreaShape::Ellipse);
  EXPECT_EQ(area("ellipse").area_size_y, 3.0F);
}

TEST(GltfLamp, ExtrasWithoutEffectAreNamed)
{
  GltfBuilder builder = triangle_scene();
  builder.light({{"type", "directional"}}, {{"gnomon_raduis", 1}, {"gnomon_radius", 1}});
  builder.light({{"type", "directional"}}, {{"gnomon_lamp", "hemi"}, {"gnomon_bias", 1}}, {{"name", "sky"}});
  builder.node({{"name", "plain"}, {"extras", {{"gnomon_power", 1}}}});
  const Scene scene = import(builder);
  EXPECT_WARNING(scene, "lamp 'lamp': extra 'gnomon_raduis' is unknown");
  EXPECT_WARNING(scene, "lamp 'lamp': extra 'gnomon_radius' does not apply");
  EXPECT_WARNING(scene, "lamp 'sky': extra 'gnomon_bias' does not apply");
  EXPECT_WARNING(scene, "node 'plain': extra 'gnomon_power' has no effect");
}

TEST(GltfLamp, ScaleShearAndMirrorLeaveAFrame)
{
  const auto frame = [](const json &more) {
    return import_lamp({{"type", "directional"}}, nullptr, more).world_from_lamp;
  };
  // The direction is the node's -Z for every matrix.
  expect_near(-glm::vec3(frame({{"scale", {5, 0.1, 3}}})[2]), {0, 0, -1});
  expect_near(-glm::vec3(frame({{"scale", {-1, 1, 1}}})[2]), {0, 0, -1});
  expect_near(-glm::vec3(frame({{"scale", {1, 1, -2}}})[2]), {0, 0, 1});
  expect_near(glm::vec3(frame({{"scale", {1, -3, 1}}})[1]), {0, -1, 0});
  const glm::mat4 sheared = frame({{"matrix", {1, 0, 0, 0, 0.5, 1, 0.75, 0, 0, 3, 4, 0, 7, 8, 9, 1}}});
  expect_near(-glm::vec3(sheared[2]), {0, -0.6F, -0.8F});
  expect_near(glm::vec3(sheared[3]), {7, 8, 9});
  // expect_valid checks that each frame is right-handed and orthonormal, also for these matrices, which collapse axes.
  for (const json &scale :
       json{{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1e-200, 1e-200, 1e-200}}) {
    const double s = std::sqrt(0.5);
    frame({{"scale", scale}, {"rotation", {s, 0, 0, s}}});
  }
  const double s = std::sqrt(0.5);
  // Flattened along z: the frame follows from the other two axes.
  expect_near(-glm::vec3(frame({{"scale", {1, 1, 0}}, {"rotation", {s, 0, 0, s}}})[2]), {0, 1, 0});
}

TEST(GltfLamp, NamesComeFromTheNodeThenTheLight)
{
  EXPECT_EQ(import_lamp({{"type", "point"}, {"name", "bulb"}}).name, "lamp");
  GltfBuilder builder = triangle_scene();
  const int node = builder.light({{"type", "point"}, {"name", "bulb"}});
  builder.document["nodes"][node].erase("name");
  EXPECT_EQ(import(builder).placed_lamps().at(0).name, "bulb");
}

std::string lamp_error(json light, json extras = nullptr)
{
  GltfBuilder builder = triangle_scene();
  builder.light(std::move(light), std::move(extras));
  return import_error(builder);
}

TEST(GltfLamp, BadValuesAreErrorsThatNameLampKeyAndValue)
{
  const json point = {{"type", "point"}};
  const json sun = {{"type", "directional"}};
  const json spot = {{"type", "spot"}, {"spot", json::object()}};
  EXPECT_HAS(lamp_error(point, {{"gnomon_radius", -1}}),
             "lamp 'lamp': gnomon_radius is -1, and must be from 0 to 1e+12");
  EXPECT_HAS(lamp_error(point, {{"gnomon_radius", "big"}}),
             "lamp 'lamp': gnomon_radius is 'big', and must be a number");
  EXPECT_HAS(lamp_error(point, {{"gnomon_radius", true}}), "gnomon_radius is true");
  EXPECT_HAS(lamp_error(point, {{"gnomon_radius", {1, 2}}}), "gnomon_radius is an array");
  EXPECT_HAS(lamp_error(point, {{"gnomon_radius", nullptr}}), "'lamp': extra gnomon_radius is null");
  EXPECT_HAS(lamp_error(point, {{"gnomon_radius", {{"a", 1}}}}), "extra gnomon_radius is an object");
  EXPECT_HAS(lamp_error(point, {{"gnomon_radius", 1e300}}), "gnomon_radius is 1e+300");
  // An integer of more than 32 bits is not truncated.
  EXPECT_HAS(lamp_error(point, {{"gnomon_radius", 4294967296000000001}}), "gnomon_radius is 4.29497e+18");
  EXPECT_HAS(lamp_error(point, {{"gnomon_shadow", "soft"}}),
             "lamp 'lamp': gnomon_shadow is 'soft', and must be 'none', 'hard', 'pcf', 'esm' or 'evsm'");
  EXPECT_HAS(lamp_error(point, {{"gnomon_shadow", 1}}), "gnomon_shadow is 1, and must be a string");
  EXPECT_HAS(lamp_error(point, {{"gnomon_esm_format", "8"}}), "gnomon_esm_format is '8', and must be '16f' or '32f'");
  EXPECT_HAS(lamp_error(point, {{"gnomon_shadow_size", 0}}), "gnomon_shadow_size is 0, and must be from 1 to 16384");
  EXPECT_HAS(lamp_error(sun, {{"gnomon_shadow_size", 16385}}), "gnomon_shadow_size is 16385");
  EXPECT_HAS(lamp_error(point, {{"gnomon_esm_size", 5.5}}), "gnomon_esm_size is 5.5, and must be a whole number");
  EXPECT_HAS(lamp_error(point, {{"gnomon_exponent", 0}}), "gnomon_exponent is 0, and must be from 0.01 to 10000");
  EXPECT_HAS(lamp_error(point, {{"gnomon_bias", -1}}), "gnomon_bias is -1, and must be from 0 to 100");
  EXPECT_HAS(lamp_error(point, {{"gnomon_clip_start", 0}}), "gnomon_clip_start is 0");
  EXPECT_HAS(lamp_error(point, {{"gnomon_clip_start", 2}, {"gnomon_clip_end", 2}}),
             "gnomon_clip_end is 2, and must be above gnomon_clip_start, 2");
  EXPECT_HAS(lamp_error(point, {{"gnomon_filter_radius", 46}}), "gnomon_filter_radius is 46, and must be from 0 to 45");
  EXPECT_HAS(lamp_error(sun, {{"gnomon_angle", 4}}), "gnomon_angle is 4, and must be from 0 to 3.14159");
  EXPECT_HAS(lamp_error(spot, {{"gnomon_spot_blend", 1.5}}), "gnomon_spot_blend is 1.5, and must be from 0 to 1");
  EXPECT_HAS(lamp_error(sun, {{"gnomon_lamp", "moon"}}), "gnomon_lamp is 'moon', and must be 'hemi'");
  EXPECT_HAS(lamp_error(point, {{"gnomon_lamp", "hemi"}}),
             "gnomon_lamp is 'hemi', and must be absent on a point light");
  EXPECT_HAS(lamp_error(point, {{"gnomon_lamp", "area"}}), "gnomon_lamp is 'area'");
  EXPECT_HAS(lamp_error(sun, {{"gnomon_lamp", 3}}), "gnomon_lamp is 3, and must be a string");
}

TEST(GltfLamp, BadLightsAreErrors)
{
  EXPECT_HAS(lamp_error({{"type", "moon"}}), "lamp 'lamp': type is 'moon'");
  EXPECT_HAS(lamp_error({{"type", "point"}, {"intensity", -1}}), "lamp 'lamp': intensity is -1");
  EXPECT_HAS(lamp_error({{"type", "point"}, {"intensity", 1e300}}), "intensity is 1e+300");
  EXPECT_HAS(lamp_error({{"type", "point"}, {"color", {1, -1, 1}}}), "color is -1");
  EXPECT_HAS(lamp_error({{"type", "point"}, {"color", {1, 1}}}),
             "color: is an array, and must be an array of 3 numbers");
  EXPECT_HAS(lamp_error({{"type", "point"}, {"range", -1}}), "range is -1, and must be from 1e-12 to 1e+12");
  EXPECT_HAS(lamp_error({{"type", "spot"}, {"spot", {{"outerConeAngle", 2}}}}),
             "outerConeAngle is 2, and must be from 1e-09");
  EXPECT_HAS(lamp_error({{"type", "spot"}, {"spot", {{"outerConeAngle", 0}}}}), "outerConeAngle is 0");
  EXPECT_HAS(lamp_error({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.6}, {"outerConeAngle", 0.5}}}}),
             "innerConeAngle is 0.6");
  EXPECT_HAS(lamp_error({{"type", "spot"}, {"spot", {{"innerConeAngle", -0.1}}}}), "innerConeAngle is -0.1");
}

std::string area_error(json extras)
{
  GltfBuilder builder = triangle_scene();
  extras["gnomon_lamp"] = extras.value("gnomon_lamp", "area");
  builder.node({{"name", "panel"}, {"extras", std::move(extras)}});
  return import_error(builder);
}

TEST(GltfLamp, BadAreasAreErrors)
{
  EXPECT_HAS(area_error({{"gnomon_lamp", "hemi"}}), "lamp 'panel': gnomon_lamp is 'hemi'");
  EXPECT_HAS(area_error({{"gnomon_shape", "star"}}), "lamp 'panel': gnomon_shape is 'star'");
  EXPECT_HAS(area_error({{"gnomon_size_x", 0}}), "lamp 'panel': gnomon_size_x is 0");
  EXPECT_HAS(area_error({{"gnomon_size_y", -2}}), "lamp 'panel': gnomon_size_y is -2");
  EXPECT_HAS(area_error({{"gnomon_power", -1}}), "lamp 'panel': gnomon_power is -1");
  EXPECT_HAS(area_error({{"gnomon_color", {1, 1}}}),
             "lamp 'panel': gnomon_color is an array, and must be three numbers");
  EXPECT_HAS(area_error({{"gnomon_color", {1, 1, -1}}}), "lamp 'panel': gnomon_color is -1");
}

// ---- Cameras ----

Scene import_camera(const json &camera, json node = json::object())
{
  GltfBuilder builder = triangle_scene();
  builder.append("cameras", camera);
  node.update({{"name", "eye"}, {"camera", 0}});
  builder.node(node);
  return import(builder);
}

TEST(GltfCamera, Perspective)
{
  const Scene scene = import_camera(
      {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}, {"zfar", 100}, {"aspectRatio", 1.5}}}},
      {{"translation", {1, 2, 3}}, {"scale", {2, 2, 2}}});
  ASSERT_EQ(scene.placed_cameras().size(), 1U);
  EXPECT_FALSE(scene.is_camera_default);
  const PlacedCamera camera = scene.placed_cameras()[0];
  EXPECT_EQ(camera.name, "eye");
  EXPECT_EQ(camera.kind, CameraKind::Perspective);
  EXPECT_EQ(camera.vertical_angle, 0.5F);
  EXPECT_EQ(camera.near, 0.25F);
  EXPECT_EQ(camera.far, 100.0F);
  EXPECT_EQ(camera.aspect, 1.5F);
  expect_near(glm::vec3(camera.world_from_camera[3]), {1, 2, 3});
}

TEST(GltfCamera, AbsentAspectAndFarAreZero)
{
  const Scene scene = import_camera({{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}}}});
  EXPECT_EQ(scene.placed_cameras().at(0).aspect, 0.0F);
  EXPECT_EQ(scene.placed_cameras().at(0).far, 0.0F);
}

TEST(GltfCamera, Orthographic)
{
  const Scene scene = import_camera(
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 4}, {"ymag", 3}, {"znear", 0}, {"zfar", 50}}}});
  const PlacedCamera camera = scene.placed_cameras().at(0);
  EXPECT_EQ(camera.kind, CameraKind::Orthographic);
  EXPECT_EQ(camera.half_width, 4.0F);
  EXPECT_EQ(camera.half_height, 3.0F);
  EXPECT_EQ(camera.near, 0.0F);
  EXPECT_EQ(camera.far, 50.0F);
}

TEST(GltfCamera, NegativeSizesAreThoseOfMirroredPictures)
{
  const Scene scene = import_camera(
      {{"type", "orthographic"}, {"orthographic", {{"xmag", -4}, {"ymag", -3}, {"znear", 0}, {"zfar", 50}}}});
  EXPECT_FALSE(scene.is_camera_default);
  EXPECT_EQ(scene.placed_cameras().at(0).half_width, -4.0F);
  EXPECT_EQ(scene.placed_cameras().at(0).half_height, -3.0F);
}

TEST(GltfCamera, EachNodeWithOneIsAnEntry)
{
  GltfBuilder builder = triangle_scene();
  builder.append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}}}});
  builder.node({{"name", "first"}, {"camera", 0}});
  builder.node({{"name", "second"}, {"camera", 0}});
  const Scene scene = import(builder);
  ASSERT_EQ(scene.placed_cameras().size(), 2U);
  EXPECT_EQ(scene.placed_cameras()[0].name, "first");
  EXPECT_EQ(scene.placed_cameras()[1].name, "second");
}

TEST(GltfCamera, BadNumbersLeaveItOut)
{
  const auto expect_left_out = [](const char *type, const json &numbers, const std::string &reason) {
    const Scene scene = import_camera({{"type", type}, {type, numbers}});
    EXPECT_TRUE(scene.is_camera_default);
    EXPECT_WARNING(scene, "camera 'eye': left out: " + reason);
  };
  expect_left_out("perspective", {{"yfov", 4}, {"znear", 1}}, "yfov 4");
  expect_left_out("perspective", {{"yfov", 0}, {"znear", 1}}, "yfov 0");
  expect_left_out("perspective", {{"yfov", 1}, {"znear", 0}}, "znear 0");
  expect_left_out("perspective", {{"yfov", 1}, {"znear", 2}, {"zfar", 1}}, "zfar 1 is not above znear 2");
  expect_left_out("perspective", {{"yfov", 1}, {"znear", 1}, {"zfar", 1e300}}, "zfar");
  expect_left_out("perspective", {{"yfov", 1}, {"znear", 1}, {"aspectRatio", -1}}, "aspectRatio -1");
  expect_left_out("orthographic", {{"xmag", 0}, {"ymag", 1}, {"znear", 0}, {"zfar", 1}}, "xmag 0");
  expect_left_out("orthographic", {{"xmag", -1e-13}, {"ymag", 1}, {"znear", 0}, {"zfar", 1}}, "xmag -1e-13");
  expect_left_out("orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 1}, {"zfar", 1}}, "zfar 1");
  expect_left_out("orthographic", {{"xmag", 1}, {"ymag", 1e30}, {"znear", 0}, {"zfar", 1}},
                  "ymag 1e+30 must be from 1e-12 to 1e+12, or the negative of such a number");
}

/** Expects every corner of \a bounds to lie in the frame of a square image, between near and far. */
void expect_frames(const PlacedCamera &camera, const scene::Bounds &bounds)
{
  const glm::mat4 camera_from_world(glm::inverse(camera.world_from_camera));
  const float slope = std::tan(0.5F * camera.vertical_angle);
  for (int corner = 0; corner < 8; corner++) {
    const glm::vec3 point((corner & 1) != 0 ? bounds.max.x : bounds.min.x,
                          (corner & 2) != 0 ? bounds.max.y : bounds.min.y,
                          (corner & 4) != 0 ? bounds.max.z : bounds.min.z);
    const glm::vec3 p(camera_from_world * glm::vec4(point, 1));
    EXPECT_LT(std::abs(p.x), -p.z * slope);
    EXPECT_LT(std::abs(p.y), -p.z * slope);
    EXPECT_GT(-p.z, camera.near);
    EXPECT_LT(-p.z, camera.far);
  }
}

TEST(GltfCamera, DefaultFramesTheScene)
{
  GltfBuilder builder = triangle_scene();
  builder.document["nodes"][0].update({{"translation", {100, -20, 7}}, {"scale", {3, 0.5, 1}}});
  const Scene scene = import(builder);
  EXPECT_TRUE(scene.is_camera_default);
  EXPECT_WARNING(scene, "has no camera: one was added");
  expect_frames(scene.placed_cameras().at(0), scene.bounds());
  // From above, and upright.
  EXPECT_GT(scene.placed_cameras()[0].world_from_camera[2].y, 0.2F);
  EXPECT_GT(scene.placed_cameras()[0].world_from_camera[1].y, 0.5F);
}

TEST(GltfCamera, DefaultFramesTheVeryLargeAndSmall)
{
  for (const double scale : {1e-9, 1e-3, 1e6, 1e11}) {
    GltfBuilder builder = triangle_scene();
    builder.document["nodes"][0]["scale"] = {scale, scale, scale};
    const Scene scene = import(builder);
    expect_frames(scene.placed_cameras().at(0), scene.bounds());
  }
}

TEST(GltfLamp, DefaultSunShinesFromAboveAndLeftOfTheCamera)
{
  const Scene scene = import(triangle_scene());
  EXPECT_TRUE(scene.is_lamp_default);
  ASSERT_EQ(scene.placed_lamps().size(), 1U);
  EXPECT_EQ(scene.placed_lamps()[0].kind, LampKind::Sun);
  EXPECT_WARNING(scene, "has no lamp: a sun of 3.14 W/m2 was added, above and to the left of camera 'default'");
  const glm::vec3 light = -glm::vec3(scene.placed_lamps()[0].world_from_lamp[2]);
  const glm::mat4 view(scene.placed_cameras().at(0).world_from_camera);
  EXPECT_GT(glm::dot(light, -glm::vec3(view[2])), 0.5F);
  EXPECT_LT(glm::dot(light, glm::vec3(view[1])), -0.3F);
}

TEST(GltfImport, EmptySceneStillHasACameraAndALamp)
{
  GltfBuilder builder;
  const Scene nothing = import(builder);
  EXPECT_TRUE(nothing.objects().empty());
  EXPECT_TRUE(nothing.is_camera_default && nothing.is_lamp_default);
  EXPECT_WARNING(nothing, "scene: has nothing to draw");
  builder.append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}}}});
  builder.node({{"camera", 0}});
  EXPECT_FALSE(import(builder).is_camera_default);
}

TEST(GltfImport, EqualWarningsAreCounted)
{
  GltfBuilder builder = triangle_scene();
  const json odd = {{"attributes", {{"POSITION", 0}}}, {"mode", 9}};
  for (int i = 0; i < 1000; i++) {
    builder.node({{"mesh", builder.mesh(odd, "wire" + std::to_string(i))}});
  }
  const Scene scene = import(builder);
  EXPECT_WARNING(scene, "mesh 'wire0' and 999 others: primitive left out: mode: 9 is unknown (1000 times)");
  EXPECT_LE(scene.warnings.size(), 3U);
}

}  // namespace
}  // namespace gnomon::test
