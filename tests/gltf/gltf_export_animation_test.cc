// SPDX-License-Identifier: MIT
// Animations, skins and morph targets that are written and read back.
#include "gltf_export.hh"

#include "gltf/gltf_animated.hh"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace gnomon::test {
namespace {

using scene::Handle;
using scene::Scene;

/** The largest difference between coordinates of the vertices of all objects in world space, metres. */
double difference(const Scene &a, const Scene &b)
{
  const auto objects_by_name = [](const Scene &scene) {
    std::vector<scene::Object> objects = scene.objects();
    std::ranges::stable_sort(objects, {}, [&](const scene::Object &object) { return scene.nodes()[object.node].name; });
    return objects;
  };
  const std::vector<scene::Object> first = objects_by_name(a);
  const std::vector<scene::Object> second = objects_by_name(b);
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

/**
 * Nodes that show the deformed mesh of another node, in all places that a tree has: beside it, below it, below a joint,
 * and with children of their own. What the other node's ancestors and the joints have in common may move.
 */
TEST_F(GltfExportAnimation, CopiesOfASkinnedNodeKeepTheirPlaceAndTheirMotion)
{
  for (const bool is_below_an_armature : {false, true}) {
    SCOPED_TRACE(is_below_an_armature);
    GltfBuilder builder = skinned_triangle();
    builder.document["nodes"][0]["translation"] = {0.5, -1, 2};
    builder.document["nodes"][0]["rotation"] = {0, 0.6, 0, 0.8};
    builder.document["nodes"][0]["scale"] = {1, 2, 0.5};
    builder.node({{"name", "foot"}, {"translation", {0, 0, 1}}});
    builder.document["nodes"][2]["children"] = {3};
    builder.document["nodes"][1]["children"] = {2};
    builder.document["scenes"] = {{{"nodes", {0, 1}}}};
    builder.document["skins"][0]["joints"] = {1, 3};
    add_channel(builder, {{"node", 2}, {"path", "translation"}}, {0, 1}, {1, 0, 0, 1, 0, 2}, "VEC3");
    add_channel(builder, {{"node", 1}, {"path", "rotation"}}, {0, 2}, {0, 0, 0, 1, 0, 0, 0.6F, 0.8F}, "VEC4");
    if (is_below_an_armature) {
      const int armature = builder.node({{"name", "armature"}, {"children", {0, 1}}, {"scale", {2, 1, 1}}});
      const int world = builder.node({{"name", "world"}, {"children", {armature}}, {"translation", {7, 0, 0}}});
      builder.document["scenes"] = {{{"nodes", {world}}}};
      add_channel(builder, {{"node", armature}, {"path", "translation"}}, {0, 1.5F}, {0, 0, 0, 0, 5, 0}, "VEC3");
    }
    Scene scene = import(builder);
    const auto find = [&](const std::string &name) {
      return std::ranges::find_if(scene.nodes(), [&](const auto &item) { return item.value.name == name; })->handle;
    };
    const scene::DeformedMesh &deformed = scene.deformed_meshes.at(0);
    const auto original = deformed.node;
    const auto joint = find("foot");
    const auto place = [](const glm::dvec3 &way) {
      return glm::rotate(glm::translate(glm::dmat4(1.0), way), 0.7, glm::dvec3(0, 1, 0));
    };
    scene::Node copy = scene.nodes()[original];
    for (const auto parent : {Handle<scene::Node>(), original, joint, scene.parent(original)}) {
      copy.name += '+';
      copy.parent_from_node = place({5.0 + double(copy.name.size()), 0, 0});
      scene.add(scene::Node{.name = "child"}, scene.add(copy, parent));
    }
    scene::pose(scene, scene.animations[0], 0.4);
    Scene read = read_back(scene);
    EXPECT_LT(glm::length(read.bounds().max - scene.bounds().max), 1e-5F);
    EXPECT_EQ(read.deformed_meshes.size(), 5U);
    expect_same_motion(scene, read);
    Scene again = read_back(read, "again.gltf");
    expect_same_motion(read, again);
    // Without the original, the copies stand still, as they do in the scene.
    scene.remove(find("foot"));
    scene.remove(original);
    Scene still = read_back(scene);
    EXPECT_TRUE(still.deformed_meshes.empty());
    expect_same_motion(scene, still);
  }
}

TEST_F(GltfExportAnimation, ACopyOfANodeWithoutVolumeIsWrittenAsItStands)
{
  GltfBuilder builder = skinned_triangle();
  builder.document["nodes"][0]["scale"] = {1, 0, 1};
  // Without a child, the transform would be left out.
  builder.document["nodes"][0]["children"] = {builder.document["nodes"].size()};
  builder.append("nodes", {{"name", "child"}});
  Scene scene = import(builder);
  scene::Node copy = scene.nodes()[scene.deformed_meshes.at(0).node];
  copy.parent_from_node = glm::translate(glm::dmat4(1.0), {5, 0, 0});
  scene.add(copy);
  const Scene read = read_back(scene);
  EXPECT_EQ(read.deformed_meshes.size(), 1U);
  EXPECT_LT(difference(scene, read), 1e-6);
}

TEST_F(GltfExportAnimation, ACopyOfAMorphedNodeFollowsTheSameWeights)
{
  GltfBuilder builder = triangle_scene();
  const int up = builder.positions({0, 0, 1, 0, 0, 1, 0, 0, 1});
  builder.document["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}}};
  add_channel(builder, {{"node", 0}, {"path", "weights"}}, {0, 1}, {0.5F, 2}, "SCALAR");
  Scene scene = import(builder);
  scene::Node copy = scene.nodes()[scene.deformed_meshes.at(0).node];
  copy.parent_from_node = glm::translate(glm::dmat4(1.0), {5, 0, 0});
  scene.add(copy);
  Scene read = read_back(scene);
  expect_same_motion(scene, read);
}

TEST_F(GltfExportAnimation, EditsOfDeformedMeshesReadBack)
{
  GltfBuilder builder = skinned_triangle();
  add_channel(builder, {{"node", 2}, {"path", "translation"}}, {0, 1}, {1, 0, 0, 1, 0, 2}, "VEC3");
  Scene scene = import(builder);
  scene::pose(scene, scene.animations[0], 0.5);
  const auto mesh = scene.deformed_meshes[0].mesh;
  scene.edit(mesh, [](scene::Mesh &edited) { edited.positions[2] = {3, 3, 3}; });
  Scene read = read_back(scene);
  expect_same_motion(scene, read);
  EXPECT_GT(read.bounds().max.y, 2.0F);
  // With more vertices than its rest shape it is written as it stands.
  scene.edit(mesh, [](scene::Mesh &edited) {
    edited.positions.push_back({9, 9, 9});
    edited.normals.push_back({0, 0, 1});
    edited.indices.insert(edited.indices.end(), {0, 1, 3});
  });
  const Scene still = read_back(scene);
  EXPECT_TRUE(still.deformed_meshes.empty());
  EXPECT_EQ(still.bounds().max, scene.bounds().max);
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
  // Each key has three weights, as many numbers as a vector.
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
