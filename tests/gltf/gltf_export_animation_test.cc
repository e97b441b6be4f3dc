// SPDX-License-Identifier: MIT
// Animations, skins and morph targets that are written and read back.
#include "gltf_export.hh"

#include "gltf/gltf_animated.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <cmath>

namespace gnomon::test {
namespace {

using scene::Handle;
using scene::Scene;

/** The largest difference between coordinates of the vertices of all objects in world space, metres. */
double difference(const Scene &a, const Scene &b)
{
  const std::vector<scene::Object> first = a.objects();
  const std::vector<scene::Object> second = b.objects();
  EXPECT_EQ(first.size(), second.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < std::min(first.size(), second.size()); i++) {
    const scene::Mesh &mesh = a.meshes()[first[i].mesh];
    const scene::Mesh &other = b.meshes()[second[i].mesh];
    EXPECT_EQ(mesh.positions.size(), other.positions.size());
    for (std::size_t v = 0; v < std::min(mesh.positions.size(), other.positions.size()); v++) {
      const glm::dvec4 p = first[i].world_from_object * glm::dvec4(mesh.positions[v], 1.0);
      const glm::dvec4 q = second[i].world_from_object * glm::dvec4(other.positions[v], 1.0);
      largest = std::max(largest, glm::length(p - q));
      const glm::vec3 turned = mesh.normals[v] - other.normals[v];
      largest = std::max(largest, double(glm::length(turned)));
    }
  }
  return largest;
}

class GltfExportAnimation : public testing::Test {
 protected:
  Scene read_back(const Scene &scene, const char *name = "copy.glb")
  {
    const std::filesystem::path path = folder.path() / name;
    gltf::export_gltf(scene, path);
    Scene copy = gltf::import_gltf(path);
    expect_valid(copy);
    return copy;
  }
  /** Both scenes show the same at several times of their only animation. */
  static void expect_same_motion(Scene &scene, Scene &copy)
  {
    ASSERT_EQ(scene.animations.size(), 1U);
    ASSERT_EQ(copy.animations.size(), 1U);
    EXPECT_EQ(copy.animations[0].name, scene.animations[0].name);
    EXPECT_EQ(copy.animations[0].duration(), scene.animations[0].duration());
    EXPECT_LT(difference(scene, copy), 1e-6) << "as it was written";
    for (const double seconds : {0.0, 0.2, 0.5, 1.0, 1.7, 3.0}) {
      scene::pose(scene, scene.animations[0], seconds);
      scene::pose(copy, copy.animations[0], seconds);
      EXPECT_LT(difference(scene, copy), 1e-6) << seconds;
    }
  }

  TemporaryFolder folder;
};

TEST_F(GltfExportAnimation, TransformsOfNodesReadBackInEachInterpolation)
{
  for (const char *interpolation : {"STEP", "LINEAR", "CUBICSPLINE"}) {
    SCOPED_TRACE(interpolation);
    const bool is_spline = std::string(interpolation) == "CUBICSPLINE";
    const auto keys = [&](std::vector<float> values, std::size_t width) {
      std::vector<float> result;
      for (std::size_t i = 0; i < values.size(); i += width) {
        const std::vector<float> tangent(is_spline ? width : 0, 0.25F);
        result.insert(result.end(), tangent.begin(), tangent.end());
        result.insert(result.end(), values.begin() + std::ptrdiff_t(i), values.begin() + std::ptrdiff_t(i + width));
        result.insert(result.end(), tangent.begin(), tangent.end());
      }
      return result;
    };
    GltfBuilder builder = triangle_scene();
    json &node = builder.document["nodes"][0];
    node["translation"] = {0.1, 0.2, 0.3};
    node["rotation"] = {0.5, 0.5, 0.5, 0.5};
    node["scale"] = {1.0, -2.0, 3.0};
    const int parent = builder.node({{"name", "parent"}, {"children", {0}}, {"scale", {2.0, 2.0, 0.5}}});
    builder.document["scenes"] = {{{"nodes", {parent}}}};
    add_channel(builder, {{"node", 0}, {"path", "translation"}}, {0.25F, 1, 2}, keys({0, 1, 2, 3, 4, 5, -1, 0, 1}, 3),
                "VEC3", interpolation);
    add_channel(builder, {{"node", parent}, {"path", "rotation"}}, {0, 1}, keys({0, 0, 0, 1, 0, 0.6F, 0, 0.8F}, 4),
                "VEC4", interpolation);
    add_channel(builder, {{"node", parent}, {"path", "scale"}}, {0, 2}, keys({1, 1, 1, -1, 2, 3}, 3), "VEC3",
                interpolation);
    Scene scene = import(builder);
    scene::pose(scene, scene.animations.at(0), 0.6);
    Scene copy = read_back(scene);
    expect_same_motion(scene, copy);
  }
}

TEST_F(GltfExportAnimation, SkinsReadBackInAnyPose)
{
  GltfBuilder builder = skinned_triangle();
  add_channel(builder, {{"node", 2}, {"path", "translation"}}, {0, 1}, {1, 0, 0, 1, 0, 2}, "VEC3");
  Scene scene = import(builder);
  scene::pose(scene, scene.animations[0], 1.0);
  Scene copy = read_back(scene);
  expect_same_motion(scene, copy);
}

TEST_F(GltfExportAnimation, ARemovedJointStaysAtRest)
{
  GltfBuilder builder = skinned_triangle();
  add_channel(builder, {{"node", 1}, {"path", "translation"}}, {0, 1}, {0, 0, 0, 0, 0, 2}, "VEC3");
  Scene scene = import(builder);
  scene.remove(scene.skins.at(0).joints.at(1));
  scene::deform_meshes(scene);
  Scene copy = read_back(scene);
  expect_same_motion(scene, copy);
}

TEST_F(GltfExportAnimation, MorphTargetsReadBackWithTheirWeights)
{
  GltfBuilder builder = triangle_scene();
  json &primitive = builder.document["meshes"][0]["primitives"][0];
  primitive["attributes"]["NORMAL"] = builder.positions({0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int up = builder.positions({0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int right = builder.positions({2, 0, 0, 2, 0, 0, 2, 0, 0});
  const int turned = builder.positions({1, 0, -1, 0, 1, -1, 0, 0, 0});
  primitive["targets"] = {{{"POSITION", up}, {"NORMAL", turned}}, {{"POSITION", right}}, {{"POSITION", turned}}};
  builder.document["meshes"][0]["weights"] = {0.5, 0.0, 0.25};
  builder.node({{"name", "other"}, {"mesh", 0}, {"weights", {0.0, 1.0, 0.0}}});
  // As many as the numbers of a vector.
  add_channel(builder, {{"node", 0}, {"path", "weights"}}, {0, 1}, {0.5F, 0, 1, 1, 0.5F, -1}, "SCALAR");
  Scene scene = import(builder);
  scene::pose(scene, scene.animations[0], 0.3);
  Scene copy = read_back(scene);
  expect_same_motion(scene, copy);
  Scene text = read_back(scene, "copy.gltf");
  expect_same_motion(scene, text);
}

TEST_F(GltfExportAnimation, PropertiesOfLampsMaterialsAndCamerasReadBack)
{
  GltfBuilder builder = triangle_scene();
  builder.document["meshes"][0]["primitives"][0]["material"] = 0;
  builder.append("materials", {{"name", "paint"},
                               {"emissiveFactor", {1.0, 0.5, 0.25}},
                               {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 5.0}}}}}});
  builder.light({{"type", "point"}, {"intensity", 683.0}});
  builder.document["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}};
  builder.node({{"camera", 0}});
  const auto pointer = [](const std::string &text) {
    return json{{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", text}}}}}};
  };
  const std::string light = "/extensions/KHR_lights_punctual/lights/0/";
  add_channel(builder, pointer(light + "intensity"), {0, 1}, {683, 1366}, "SCALAR");
  add_channel(builder, pointer(light + "color"), {0, 1}, {1, 1, 1, 0, 0.5F, 1}, "VEC3");
  add_channel(builder, pointer("/materials/0/pbrMetallicRoughness/baseColorFactor"), {0, 1}, {1, 1, 1, 1, 0, 1, 1, 1},
              "VEC4");
  add_channel(builder, pointer("/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength"), {0, 1},
              {2, 4}, "SCALAR");
  add_channel(builder, pointer("/cameras/0/perspective/yfov"), {0, 1}, {1, 0.5F}, "SCALAR");
  Scene scene = import(builder);
  ASSERT_EQ(scene.animations.at(0).values.size(), 5U);
  Scene copy = read_back(scene);
  EXPECT_TRUE(copy.warnings.empty()) << all_warnings(copy);
  ASSERT_EQ(copy.animations.size(), 1U);
  for (const double seconds : {0.0, 0.3, 1.0}) {
    SCOPED_TRACE(seconds);
    scene::pose(scene, scene.animations[0], seconds);
    scene::pose(copy, copy.animations[0], seconds);
    const auto expect_near = [](const glm::vec3 &a, const glm::vec3 &b) {
      EXPECT_LT(glm::length(a - b), 1e-6F * (1.0F + glm::length(a)));
    };
    expect_near(nth(scene.lamps(), 0).color, nth(copy.lamps(), 0).color);
    EXPECT_FLOAT_EQ(nth(scene.lamps(), 0).intensity, nth(copy.lamps(), 0).intensity);
    expect_near(nth(scene.materials(), 0).base_color, nth(copy.materials(), 0).base_color);
    expect_near(nth(scene.materials(), 0).emissive, nth(copy.materials(), 0).emissive);
    EXPECT_FLOAT_EQ(nth(scene.cameras(), 0).vertical_angle, nth(copy.cameras(), 0).vertical_angle);
  }
}

TEST_F(GltfExportAnimation, ChannelsOfRemovedThingsAreNotWritten)
{
  GltfBuilder builder = triangle_scene();
  builder.node({{"name", "still"}, {"mesh", 0}});
  add_channel(builder, {{"node", 0}, {"path", "translation"}}, {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3");
  Scene scene = import(builder);
  scene.remove(scene.nodes().first());
  const Scene copy = read_back(scene);
  EXPECT_TRUE(copy.animations.empty());
  EXPECT_TRUE(copy.warnings.empty() || !has_warning(copy, "channel")) << all_warnings(copy);
}

}  // namespace
}  // namespace gnomon::test
