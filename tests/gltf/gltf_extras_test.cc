// SPDX-License-Identifier: MIT
#include "gltf/gltf_check.hh"

#include <array>
#include <limits>

namespace gnomon::test {
namespace {

using scene::Mesh;
using scene::Scene;

const Mesh &only_mesh(const Scene &scene)
{
  EXPECT_EQ(scene.meshes().size(), 1U);
  return (*scene.meshes().begin()).value;
}

/** A triangle with COLOR_0. */
template <typename T>
GltfBuilder colored_triangle(const std::vector<T> &colors, Component component, const std::string &type,
                             const json &more = json::object())
{
  GltfBuilder builder;
  const int positions = builder.positions(triangle_positions);
  json accessor = {{"bufferView", builder.view(colors)},
                   {"componentType", int(component)},
                   {"count", colors.size() / (type == "VEC4" ? 4 : 3)},
                   {"type", type}};
  accessor.update(more);
  const int color = builder.append("accessors", accessor);
  builder.node({{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}, {"COLOR_0", color}}}})}});
  return builder;
}

TEST(GltfColor, FloatsAreLinearAndKept)
{
  const std::vector<float> values{0, 0.25F, 1, 0.5F, 1, 0, 0.125F, 1, 0.1F, 0.2F, 0.3F, 0};
  const Scene scene = import(colored_triangle(values, Float32, "VEC4"));
  EXPECT_EQ(only_mesh(scene).colors,
            (std::vector<glm::vec4>{{0, 0.25F, 1, 0.5F}, {1, 0, 0.125F, 1}, {0.1F, 0.2F, 0.3F, 0}}));
  EXPECT_NO_WARNING(scene, "colour");
}

TEST(GltfColor, Vec3IsOpaque)
{
  const Scene scene = import(colored_triangle(std::vector<float>{0, 0, 1, 0, 1, 0, 1, 0, 0}, Float32, "VEC3"));
  EXPECT_EQ(only_mesh(scene).colors, (std::vector<glm::vec4>{{0, 0, 1, 1}, {0, 1, 0, 1}, {1, 0, 0, 1}}));
}

TEST(GltfColor, NormalizedIntegersAreFractions)
{
  const json normalized = {{"normalized", true}};
  const std::vector<std::uint8_t> bytes{255, 51, 0, 255, 0, 0, 0, 102, 0, 0, 0, 0};
  const Scene of_bytes = import(colored_triangle(bytes, Uint8, "VEC4", normalized));
  EXPECT_EQ(only_mesh(of_bytes).colors[0], glm::vec4(1, 0.2F, 0, 1));
  EXPECT_EQ(only_mesh(of_bytes).colors[1], glm::vec4(0, 0, 0, 0.4F));
  const std::vector<std::uint16_t> shorts{65535, 13107, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(only_mesh(import(colored_triangle(shorts, Uint16, "VEC3", normalized))).colors[0],
            glm::vec4(1, 0.2F, 0, 1));
}

TEST(GltfColor, InvalidTypesAreNamed)
{
  const std::vector<std::uint8_t> bytes(12, 255);
  const Scene plain = import(colored_triangle(bytes, Uint8, "VEC4"));
  EXPECT_TRUE(only_mesh(plain).colors.empty());
  EXPECT_WARNING(plain, "mesh 'mesh': its vertex colours are left out: COLOR_0: holds neither floats nor normalized");
  const Scene few = import(colored_triangle(std::vector<float>{1, 1, 1}, Float32, "VEC3"));
  EXPECT_TRUE(only_mesh(few).colors.empty());
  EXPECT_WARNING(few, "its vertex colours are left out: COLOR_0: count differs from that of POSITION");
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Scene odd = import(colored_triangle(std::vector<float>{nan, -1, 2, 0, 1, 0.5F, 0, 0, 0}, Float32, "VEC3"));
  EXPECT_EQ(only_mesh(odd).colors[0], glm::vec4(0, 0, 1, 1));
  EXPECT_WARNING(odd, "mesh 'mesh': vertex colour limited to 0 to 1: it was not finite or outside");
}

TEST(GltfColor, StaysWithItsVertex)
{
  // Vertices 1 and 3 have the same position and different colours; vertex 0 is used by no triangle.
  const std::vector<float> positions{9, 9, 9, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1};
  const std::vector<float> colors{0.9F, 0, 0, 0.1F, 0, 0, 0.2F, 0, 0, 0.3F, 0, 0, 0.4F, 0, 0, 0.5F, 0, 0};
  const std::array<float, 6> expected{0.1F, 0.2F, 0.4F, 0.3F, 0.4F, 0.5F};
  for (const bool has_normals : {false, true}) {
    GltfBuilder builder;
    json attributes = {{"POSITION", builder.positions(positions)},
                       {"COLOR_0", builder.accessor(colors, Float32, "VEC3")}};
    if (has_normals) {
      attributes["NORMAL"] = builder.positions({0, 0, 1, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 1, 0, 0});
    }
    const int indices = builder.accessor(std::vector<std::uint16_t>{1, 2, 4, 3, 4, 5}, Uint16, "SCALAR");
    builder.node({{"mesh", builder.mesh({{"attributes", attributes}, {"indices", indices}})}});
    const Scene scene = import(builder);
    const Mesh &mesh = only_mesh(scene);
    ASSERT_EQ(mesh.indices.size(), 6U);
    for (std::size_t i = 0; i < 6; i++) {
      EXPECT_EQ(mesh.colors[mesh.indices[i]].x, expected[i]) << i;
    }
  }
}

TEST(GltfColor, FollowsATriangleThatGetsItsOwnNormal)
{
  GltfBuilder builder;
  const int positions = builder.positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0.3F});
  const glm::vec3 n = glm::normalize(glm::cross(glm::vec3(1, 1, 0), glm::vec3(-1, 1, 0.3F)));
  const int normals = builder.positions({n.x, n.y, n.z, n.x, n.y, n.z, n.x, n.y, n.z, n.x, n.y, n.z});
  const int colors =
      builder.accessor(std::vector<float>{0.1F, 0, 0, 0.2F, 0, 0, 0.3F, 0, 0, 0.4F, 0, 0}, Float32, "VEC3");
  const int indices = builder.accessor(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3}, Uint16, "SCALAR");
  builder.node(
      {{"mesh", builder.mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}, {"COLOR_0", colors}}},
                              {"indices", indices}})}});
  const Scene scene = import(builder);
  const Mesh &mesh = only_mesh(scene);
  const std::array<float, 6> expected{0.1F, 0.2F, 0.3F, 0.1F, 0.3F, 0.4F};
  for (std::size_t i = 0; i < 6; i++) {
    EXPECT_EQ(mesh.colors[mesh.indices[i]].x, expected[i]) << i;
  }
}

// ---- Extras ----

TEST(GltfNodes, FlagsAreExtras)
{
  GltfBuilder builder = triangle_scene();
  const Scene plain = import(builder);
  const scene::Node &node = plain.nodes()[plain.nodes().first()];
  EXPECT_TRUE(node.is_visible && node.casts_shadow && node.receives_shadow);
  builder.document["nodes"][0]["extras"] = {
      {"gnomon_visible", false}, {"gnomon_casts_shadow", false}, {"gnomon_receives_shadow", false}};
  const Scene scene = import(builder);
  const scene::Node &flagged = scene.nodes()[scene.nodes().first()];
  EXPECT_FALSE(flagged.is_visible || flagged.casts_shadow || flagged.receives_shadow);
  EXPECT_NO_WARNING(scene, "gnomon_");
  builder.document["nodes"][0]["extras"] = {{"gnomon_visible", 0}};
  EXPECT_HAS(import_error(builder), "node 'thing': gnomon_visible is 0, and must be true or false");
}

TEST(GltfNodes, NamesOfLampsAndCamerasAreExtras)
{
  GltfBuilder builder = triangle_scene();
  builder.light({{"type", "point"}}, {{"gnomon_lamp_name", "bulb"}});
  builder.append("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}}}});
  builder.node({{"name", "stand"}, {"camera", 0}, {"extras", {{"gnomon_camera_name", "eye"}}}});
  const Scene scene = import(builder);
  EXPECT_EQ((*scene.lamps().begin()).value.name, "bulb");
  EXPECT_EQ((*scene.cameras().begin()).value.name, "eye");
  EXPECT_NO_WARNING(scene, "gnomon_");
}

TEST(GltfImport, OnePrimitiveOfTwoMeshesIsOneMesh)
{
  GltfBuilder builder = triangle_scene();
  const json primitive = {{"attributes", {{"POSITION", 0}}}, {"extras", {{"gnomon_name", "shared"}}}};
  builder.document["meshes"] = {{{"primitives", {primitive}}},
                                {{"primitives", {primitive, {{"attributes", {{"POSITION", 0}}}, {"mode", 5}}}}}};
  builder.node({{"name", "both"}, {"mesh", 1}});
  const Scene scene = import(builder);
  EXPECT_EQ(scene.meshes().size(), 2U);
  EXPECT_EQ(scene.objects().size(), 3U);
  EXPECT_EQ(scene.meshes()[scene.meshes().first()].name, "shared");
}

// ---- JSON ----

TEST(GltfFile, ByteOrderMarkIsSkipped)
{
  EXPECT_EQ(import_error("\xEF\xBB\xBF" + triangle_scene().gltf()), "");
}

TEST(GltfFile, WholeNumbersMayBeOfAnyLength)
{
  std::string text = triangle_scene().gltf();
  text.insert(1, R"("extras":[123456789012345678901234567890,-99999999999999999999,"\\\"99999999999999999999"],)");
  EXPECT_EQ(import_error(text), "");
  EXPECT_HAS(import_error("{\"asset\": {\"version\": \"2.0\"}, \"nodes\": [{\"mesh\": 99999999999999999999}]}"),
             "nodes[0].mesh: is ");
}

TEST(GltfFile, OfPropertiesOfOneNameTheLastCounts)
{
  std::string text = triangle_scene().gltf();
  text.insert(1, "\"nodes\":7,\"asset\":{\"version\":\"1.0\"},");
  EXPECT_EQ(import_error(text), "");
}

}  // namespace
}  // namespace gnomon::test
