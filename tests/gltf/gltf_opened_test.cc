// SPDX-License-Identifier: MIT
// Meshes that have no area, or another side, before morph targets or joints move their vertices.
#include "gltf/gltf_animated.hh"

#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <array>
#include <functional>

namespace gnomon::test {
namespace {

using scene::Scene;

/** The triangle's vertices, all at the origin, and a target that opens it. */
GltfBuilder opened_triangle(const std::function<int(GltfBuilder &)> &positions, int mode = 4)
{
  GltfBuilder builder;
  json primitive = {{"mode", mode}};
  primitive["attributes"]["POSITION"] = positions(builder);
  primitive["targets"] = {{{"POSITION", builder.positions(triangle_positions)}}};
  builder.node({{"name", "thing"}, {"mesh", builder.mesh(primitive)}});
  builder.document["meshes"][0]["weights"] = {1.0};
  return builder;
}

int no_view(GltfBuilder &builder)
{
  return builder.append("accessors", {{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}});
}

int same_places(GltfBuilder &builder)
{
  return builder.positions(std::vector<float>(9, 0.0F));
}

int on_a_line(GltfBuilder &builder)
{
  // The target adds the triangle.
  return builder.positions({0, 0, 0, 0, 0, 0, 0, 0, 0});
}

int sparse_zeros(GltfBuilder &builder)
{
  const int indices = builder.view(std::vector<std::uint16_t>{1});
  const int values = builder.view(std::vector<float>{0, 0, 0});
  return builder.append("accessors", {{"componentType", 5126},
                                      {"count", 3},
                                      {"type", "VEC3"},
                                      {"sparse",
                                       {{"count", 1},
                                        {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                        {"values", {{"bufferView", values}}}}}});
}

TEST(GltfOpened, TrianglesWithoutAreaAreOpenedByMorphTargets)
{
  for (const auto &positions : {no_view, same_places, on_a_line, sparse_zeros}) {
    for (const int mode : {4, 5, 6}) {
      const Scene scene = import(opened_triangle(positions, mode));
      ASSERT_EQ(scene.meshes().size(), 1U) << all_warnings(scene);
      const scene::Mesh &mesh = nth(scene.meshes(), 0);
      ASSERT_EQ(mesh.indices.size(), 3U);
      EXPECT_EQ(mesh.bounds.max, glm::vec3(1.0F, 1.0F, 0.0F));
      for (const glm::vec3 &normal : mesh.normals) {
        EXPECT_EQ(normal, glm::vec3(0.0F, 0.0F, 1.0F)) << "that of the opened triangle";
      }
      EXPECT_NO_WARNING(scene, "left out");
    }
  }
}

TEST(GltfOpened, LinesWithoutLengthAreOpenedByMorphTargets)
{
  for (const int mode : {1, 2, 3}) {
    GltfBuilder builder = opened_triangle(same_places, mode);
    builder.document["materials"] = {{{"name", "paint"}}};
    const Scene scene = import(builder);
    ASSERT_EQ(scene.meshes().size(), 1U) << all_warnings(scene);
    EXPECT_EQ(nth(scene.meshes(), 0).indices.size(), mode == 1 ? 2U : mode == 2 ? 6U : 4U);
    EXPECT_NO_WARNING(scene, "has no length");
  }
}

TEST(GltfOpened, TrianglesOfEqualIndicesStayClosed)
{
  GltfBuilder builder = opened_triangle(same_places);
  json &primitive = builder.document["meshes"][0]["primitives"][0];
  primitive["indices"] = builder.accessor<std::uint16_t>({0, 1, 2, 0, 1, 1}, Uint16, "SCALAR");
  const Scene scene = import(builder);
  EXPECT_EQ(nth(scene.meshes(), 0).indices.size(), 3U);
  EXPECT_WARNING(scene, "triangle left out: it has no area");
}

TEST(GltfOpened, TrianglesWithoutAreaAreOpenedByJoints)
{
  GltfBuilder builder = skinned_triangle();
  json &primitive = builder.document["meshes"][0]["primitives"][0];
  primitive["attributes"]["POSITION"] = builder.positions(std::vector<float>(9, 0.0F));
  primitive["attributes"]["JOINTS_0"] =
      builder.accessor(std::vector<std::uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0}, Uint8, "VEC4");
  builder.node({{"name", "toe"}, {"translation", {0, 1, 0}}});
  builder.document["skins"][0] = {{"joints", {1, 2, 3}}};
  const Scene scene = import(builder);
  ASSERT_EQ(scene.meshes().size(), 1U) << all_warnings(scene);
  EXPECT_EQ(nth(scene.meshes(), 0).bounds.max, glm::vec3(1.0F, 1.0F, 0.0F));
  EXPECT_EQ(nth(scene.meshes(), 0).normals[0], glm::vec3(0.0F, 0.0F, 1.0F));
}

TEST(GltfOpened, WithoutTargetsAndJointsTheyAreLeftOut)
{
  GltfBuilder builder = opened_triangle(no_view);
  builder.document["meshes"][0]["primitives"][0].erase("targets");
  EXPECT_HAS(import_error(builder), "triangle left out: it has no area");
  // A point has no area to lose.
  builder.document["meshes"][0]["primitives"][0]["mode"] = 0;
  EXPECT_EQ(nth(import(builder).meshes(), 0).indices.size(), 3U);
}

// ---- Sides of skinned meshes ----

/** Normal of the first triangle by the order of its vertices, and that of its first vertex, in world space. */
struct Sides {
  glm::dvec3 of_winding{0.0};
  glm::dvec3 of_normal{0.0};
};

Sides sides_of(const Scene &scene)
{
  const scene::Object object = scene.objects().front();
  const scene::Mesh &mesh = scene.meshes()[object.mesh];
  const glm::dmat4 &world = object.world_from_object;
  std::array<glm::dvec3, 3> corners;
  for (std::size_t i = 0; i < 3; i++) {
    corners[i] = glm::dvec3(world * glm::dvec4(mesh.positions[mesh.indices[i]], 1.0));
  }
  const glm::dmat3 linear(world);
  const double side = glm::determinant(linear) < 0.0 ? -1.0 : 1.0;
  const glm::dvec3 normal = side * glm::transpose(glm::inverse(linear)) * glm::dvec3(mesh.normals[mesh.indices[0]]);
  // Engines take the other side of mirrored objects for the front.
  return {side * glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0])),
          side * glm::normalize(normal)};
}

/** The scene with the triangle bound to one joint. */
GltfBuilder bound_triangle(const json &node, const json &joint, bool has_normals)
{
  GltfBuilder builder = triangle_scene();
  json &attributes = builder.document["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = builder.accessor(std::vector<std::uint8_t>(12, 0), Uint8, "VEC4");
  attributes["WEIGHTS_0"] = builder.accessor(std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, Float32, "VEC4");
  if (has_normals) {
    attributes["NORMAL"] = builder.accessor(std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}, Float32, "VEC3");
  }
  builder.document["skins"] = {{{"joints", {1}}}};
  builder.document["nodes"][0].update(node);
  builder.document["nodes"][0]["skin"] = 0;
  builder.node(joint);
  return builder;
}

TEST(GltfOpened, FrontsOfSkinnedTrianglesAgreeWithTheirNormals)
{
  const std::vector<json> transforms{
      json::object(),
      {{"scale", {-1, 1, 1}}},
      {{"scale", {1, -2, 1}}},
      {{"scale", {1, 1, -3}}},
      {{"scale", {-1, -1, -1}}},
      {{"scale", {-1, 1, 1}}, {"rotation", {0.5, 0.5, 0.5, 0.5}}, {"translation", {3, -4, 5}}},
      {{"matrix", {0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1}}}};
  for (const bool has_normals : {true, false}) {
    for (const json &joint : transforms) {
      const Scene plain = import(bound_triangle(json::object(), joint, has_normals));
      const Sides expected = sides_of(plain);
      for (const json &node : transforms) {
        const Scene scene = import(bound_triangle(node, joint, has_normals));
        const Sides sides = sides_of(scene);
        // Products of a few matrices of small whole numbers are rounded a few times.
        EXPECT_LE(glm::distance(sides.of_winding, expected.of_winding), 1e-6) << joint << node;
        EXPECT_LE(glm::distance(sides.of_winding, sides.of_normal), 1e-6) << joint << node;
      }
    }
  }
}

TEST(GltfOpened, FrontsTurnWithJointsAndAreWrittenAtRest)
{
  Scene scene = import(bound_triangle(json::object(), {{"scale", {-1, 1, 1}}}, true));
  const scene::DeformedMesh &deformed = scene.deformed_meshes.front();
  const std::vector<std::uint32_t> rest{0, 1, 2};
  EXPECT_EQ(scene.meshes()[deformed.mesh].indices, (std::vector<std::uint32_t>{0, 2, 1}));
  EXPECT_EQ(scene::rest_indices(scene.meshes()[deformed.mesh], deformed), rest);
  scene.set_transform(scene.skins.front().joints.front(), glm::dmat4(1.0));
  scene::deform_meshes(scene);
  EXPECT_EQ(scene.meshes()[deformed.mesh].indices, rest);
}

TEST(GltfOpened, TransformsWithoutAnInverseDoNotCloseSkinnedMeshes)
{
  const Scene plain = import(bound_triangle(json::object(), json::object(), true));
  for (const json &node :
       std::vector<json>{{{"scale", {0, 1, 1}}}, {{"scale", {0, 0, 0}}}, {{"translation", {1e30, 0, 0}}}}) {
    GltfBuilder builder = bound_triangle(node, json::object(), true);
    const Scene scene = import(builder);
    EXPECT_EQ(scene.bounds(), plain.bounds()) << node << all_warnings(scene);
    // An ancestor that is not visible hides it.
    builder.node({{"scale", {0, 0, 0}}, {"children", {0}}, {"extras", {{"gnomon_visible", false}}}});
    builder.document["scenes"][0]["nodes"] = {1, 2};
    EXPECT_TRUE(import(builder).objects().empty());
    // It stays below one that has an inverse, whose visibility may be animated.
    builder.document["nodes"].back()["scale"] = {2, 2, 2};
    Scene hidden = import(builder);
    EXPECT_TRUE(hidden.objects().empty());
    for (const auto &[handle, one] : hidden.nodes()) {
      if (!one.is_visible) {
        hidden.edit(handle, [](scene::Node &edited) { edited.is_visible = true; });
        break;
      }
    }
    EXPECT_EQ(hidden.bounds(), plain.bounds()) << node;
  }
}

}  // namespace
}  // namespace gnomon::test
