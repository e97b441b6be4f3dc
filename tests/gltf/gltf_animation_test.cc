// SPDX-License-Identifier: MIT
// Animations, skins and morph targets of files.
#include "gltf/gltf_animated.hh"

#include <glm/gtc/constants.hpp>

#include <cmath>
#include <limits>

namespace gnomon {
namespace {

using scene::Scene;
using test::add_channel;
using test::all_warnings;
using test::expect_valid;
using test::Float32;
using test::GltfBuilder;
using test::has_warning;
using test::import;
using test::json;
using test::nth;
using test::skinned_triangle;
using test::triangle_positions;
using test::triangle_scene;
using test::Uint8;

glm::dvec3 position_at(Scene &scene, double seconds)
{
  scene::pose(scene, scene.animations.at(0), seconds);
  return scene.objects().at(0).world_from_object[3];
}

TEST(GltfAnimation, StepLinearAndSplineFollowTheirFormulas)
{
  for (const char *interpolation : {"STEP", "LINEAR"}) {
    GltfBuilder builder = triangle_scene();
    add_channel(builder, {{"node", 0}, {"path", "translation"}}, {1, 3}, {0, 0, 0, 4, 8, 0}, "VEC3", interpolation);
    Scene scene = import(builder);
    const bool is_step = std::string(interpolation) == "STEP";
    EXPECT_EQ(position_at(scene, 0.0), glm::dvec3(0, 0, 0)) << "before the first key";
    EXPECT_EQ(position_at(scene, 1.5), is_step ? glm::dvec3(0, 0, 0) : glm::dvec3(1, 2, 0)) << interpolation;
    EXPECT_EQ(position_at(scene, 3.0), glm::dvec3(4, 8, 0)) << interpolation;
    EXPECT_EQ(position_at(scene, 9.0), glm::dvec3(4, 8, 0)) << "after the last key";
  }
  // x(t) = t³ from t = 0 to 2: values 0 and 8, slopes 0 and 12, which a cubic spline reproduces.
  GltfBuilder builder = triangle_scene();
  add_channel(builder, {{"node", 0}, {"path", "translation"}}, {0, 2},
              {0, 0, 0, 0, 0, 0, 0, 0, 0, 12, 0, 0, 8, 0, 0, 12, 0, 0}, "VEC3", "CUBICSPLINE");
  Scene scene = import(builder);
  EXPECT_DOUBLE_EQ(scene.animations[0].duration(), 2.0);
  for (const double t : {0.0, 0.25, 1.0, 1.7, 2.0}) {
    EXPECT_NEAR(position_at(scene, t).x, t * t * t, 1e-12) << t;
  }
}

TEST(GltfAnimation, RotationsTurnEvenlyByTheShorterWay)
{
  GltfBuilder builder = triangle_scene();
  // From 0 to 90 degrees around z; the second key has the opposite sign, which is the same rotation.
  const float half = std::sqrt(0.5F);
  add_channel(builder, {{"node", 0}, {"path", "rotation"}}, {0, 1}, {0, 0, 0, 1, 0, 0, -half, -half}, "VEC4");
  Scene scene = import(builder);
  scene::pose(scene, scene.animations[0], 1.0 / 3.0);
  const glm::dvec3 x_axis(scene.objects()[0].world_from_object[0]);
  EXPECT_NEAR(x_axis.x, std::cos(glm::pi<double>() / 6.0), 1e-7);
  EXPECT_NEAR(x_axis.y, std::sin(glm::pi<double>() / 6.0), 1e-7);
}

TEST(GltfAnimation, KeysBeyondTheRangeOfNodesAreLimited)
{
  GltfBuilder builder = triangle_scene();
  add_channel(builder, {{"node", 0}, {"path", "translation"}}, {0, 1}, {0, 0, 0, 1e30F, -1e30F, 0}, "VEC3");
  Scene scene = import(builder);
  EXPECT_EQ(position_at(scene, 1.0), glm::dvec3(1e12, -1e12, 0.0));
}

TEST(GltfAnimation, MorphTargetsAreAddedByTheirWeights)
{
  GltfBuilder builder = triangle_scene();
  const int up = builder.positions({0, 0, 1, 0, 0, 1, 0, 0, 1});
  const int right = builder.positions({2, 0, 0, 2, 0, 0, 2, 0, 0});
  builder.document["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}}, {{"POSITION", right}}};
  builder.document["meshes"][0]["weights"] = {0.5, 0.0};
  // The same mesh with weights of its own.
  builder.node({{"name", "other"}, {"mesh", 0}, {"weights", {0.0, 1.0}}});
  add_channel(builder, {{"node", 0}, {"path", "weights"}}, {0, 1}, {0.5F, 0, 1, 1}, "SCALAR");
  Scene scene = import(builder);
  EXPECT_EQ(nth(scene.meshes(), 0).positions[1], glm::vec3(1, 0, 0.5F));
  EXPECT_EQ(nth(scene.meshes(), 1).positions[1], glm::vec3(3, 0, 0));
  scene::pose(scene, scene.animations[0], 0.5);
  EXPECT_EQ(nth(scene.meshes(), 0).positions[1], glm::vec3(2, 0, 0.75F));
  EXPECT_EQ(nth(scene.meshes(), 0).bounds.max, glm::vec3(2, 1, 0.75F)) << "bounds follow";
  EXPECT_EQ(nth(scene.meshes(), 1).positions[1], glm::vec3(3, 0, 0)) << "another node's mesh";
  expect_valid(scene);
  const scene::Revision before = scene.revision();
  scene::pose(scene, scene.animations[0], 0.5);
  EXPECT_EQ(scene.revision(), before) << "the same pose is no edit";
}

TEST(GltfAnimation, AnotherNumberOfWeightsThanOfMorphTargetsIsNamed)
{
  GltfBuilder builder = triangle_scene();
  const int up = builder.positions({0, 0, 1, 0, 0, 1, 0, 0, 1});
  builder.document["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}}};
  builder.document["meshes"][0]["name"] = "sheet";
  builder.node({{"name", "two"}, {"mesh", 0}, {"weights", {0.5, 1}}});
  builder.node({{"name", "one"}, {"mesh", 0}, {"weights", {0.5}}});
  builder.node({{"name", "bare"}, {"weights", {0.5, 1, 0}}});
  const Scene scene = import(builder);
  EXPECT_WARNING(scene,
                 "node 'two': has 2 weights and 1 morph targets; weights without a target are not used, and targets "
                 "without a weight have 0");
  EXPECT_WARNING(scene,
                 "node 'bare': has 3 weights and 0 morph targets; weights without a target are not used, and targets "
                 "without a weight have 0");
  EXPECT_NO_WARNING(scene, "node 'one'");
  EXPECT_NO_WARNING(scene, "mesh 'sheet'");
  builder.document["meshes"][0]["weights"] = {1, 2, 3, 4};
  EXPECT_WARNING(import(builder),
                 "mesh 'sheet': has 4 weights and 1 morph targets; weights without a target are not used, and targets "
                 "without a weight have 0");
}

TEST(GltfAnimation, WhatMorphTargetsDoNotMoveIsNamed)
{
  GltfBuilder builder = triangle_scene();
  const int up = builder.positions({0, 0, 1, 0, 0, 1, 0, 0, 1});
  builder.document["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", up}, {"COLOR_0", up}, {"TEXCOORD_0", up}}};
  const Scene scene = import(builder);
  EXPECT_WARNING(scene, "morph target's COLOR_0 is not read");
  EXPECT_WARNING(scene, "morph target's TEXCOORD_0 is not read");
}

TEST(GltfAnimation, SkinsFollowTheirJointsAndNotTheirNode)
{
  GltfBuilder builder = skinned_triangle();
  builder.document["nodes"][0]["translation"] = {100, 0, 0};
  add_channel(builder, {{"node", 2}, {"path", "translation"}}, {0, 1}, {1, 0, 0, 1, 0, 2}, "VEC3");
  Scene scene = import(builder);
  const auto world = [&](std::size_t corner) {
    const scene::Object object = scene.objects().at(0);
    return glm::dvec3(object.world_from_object * glm::dvec4(scene.meshes()[object.mesh].positions[corner], 1.0));
  };
  EXPECT_EQ(world(0), glm::dvec3(0, 0, 0));
  EXPECT_EQ(world(1), glm::dvec3(1, 0, 0));
  scene::pose(scene, scene.animations[0], 1.0);
  EXPECT_EQ(world(0), glm::dvec3(0, 0, 0)) << "the hip does not move";
  EXPECT_EQ(world(1), glm::dvec3(1, 0, 2)) << "the knee rises";
  expect_valid(scene);
  // The file has no normals: they are those of the deformed triangle.
  const scene::Mesh &mesh = nth(scene.meshes(), 0);
  const glm::vec3 normal =
      glm::normalize(glm::cross(mesh.positions[1] - mesh.positions[0], mesh.positions[2] - mesh.positions[0]));
  EXPECT_NEAR(glm::dot(mesh.normals[0], normal), 1.0F, 1e-6F);
}

TEST(GltfAnimation, PointersAnimateLampsMaterialsAndCameras)
{
  GltfBuilder builder = triangle_scene();
  builder.document["meshes"][0]["primitives"][0]["material"] = 0;
  builder.append("materials", {{"name", "paint"}, {"emissiveFactor", {1.0, 0.5, 0.25}}});
  builder.light({{"type", "point"}, {"intensity", 683.0}});
  builder.document["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}};
  builder.node({{"camera", 0}});
  const auto pointer = [](const std::string &text) {
    return json{{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", text}}}}}};
  };
  add_channel(builder, pointer("/extensions/KHR_lights_punctual/lights/0/intensity"), {0, 1}, {683, 1366}, "SCALAR");
  add_channel(builder, pointer("/materials/0/pbrMetallicRoughness/baseColorFactor"), {0, 1}, {1, 1, 1, 1, 0, 1, 1, 1},
              "VEC4");
  add_channel(builder, pointer("/materials/0/extensions/KHR_materials_emissive_strength/emissiveStrength"), {0, 1},
              {2, 4}, "SCALAR");
  add_channel(builder, pointer("/cameras/0/perspective/yfov"), {0, 1}, {1, 0.5F}, "SCALAR");
  add_channel(builder, pointer("/nodes/0/scale"), {0, 1}, {1, 1, 1, 3, 3, 3}, "VEC3");
  add_channel(builder, pointer("/materials/0/name"), {0, 1}, {1, 2}, "SCALAR");
  Scene scene = import(builder);
  EXPECT_WARNING(scene, "animation 0: channel left out: pointer: '/materials/0/name' is not played");
  scene::pose(scene, scene.animations[0], 0.5);
  EXPECT_FLOAT_EQ(nth(scene.lamps(), 0).intensity, 1.5F);
  EXPECT_EQ(nth(scene.materials(), 0).base_color, glm::vec3(0.5F, 1, 1));
  EXPECT_EQ(nth(scene.materials(), 0).emissive, glm::vec3(3.0F, 1.5F, 0.75F));
  EXPECT_FLOAT_EQ(nth(scene.cameras(), 0).vertical_angle, 0.75F);
  EXPECT_EQ(scene.objects()[0].world_from_object[1], glm::dvec4(0, 2, 0, 0));
}

TEST(GltfAnimation, WhatCannotBePlayedIsNamedAndTheRestIsKept)
{
  const float nan = std::numeric_limits<float>::quiet_NaN();
  struct Bad {
    std::vector<float> times;
    std::vector<float> values;
    const char *interpolation;
    const char *message;
  };
  for (const Bad &bad : {Bad{{0, nan}, {0, 0, 0, 1, 1, 1}, "LINEAR", "its times do not ascend"},
                         {{1, 1}, {0, 0, 0, 1, 1, 1}, "LINEAR", "its times do not ascend"},
                         {{0, 1}, {0, 0, 0, nan, 1, 1}, "LINEAR", "a value is not finite"},
                         {{0, 1}, {0, 0, 0}, "LINEAR", "do not match"},
                         {{0, 1}, {0, 0, 0, 1, 1, 1}, "CUBICSPLINE", "do not match"},
                         {{0, 1}, {0, 0, 0, 1, 1, 1}, "CURVED", "is not one of glTF 2.0"}}) {
    GltfBuilder builder = triangle_scene();
    add_channel(builder, {{"node", 0}, {"path", "translation"}}, bad.times, bad.values, "VEC3", bad.interpolation);
    add_channel(builder, {{"node", 0}, {"path", "scale"}}, {0, 1}, {1, 1, 1, 2, 2, 2}, "VEC3");
    Scene scene = import(builder);
    EXPECT_WARNING(scene, bad.message);
    scene::pose(scene, scene.animations.at(0), 1.0);
    EXPECT_EQ(scene.objects()[0].world_from_object[0].x, 2.0) << "the other channel is played";
  }
}

TEST(GltfAnimation, DamagedSkinsAreNamedAndFinite)
{
  GltfBuilder without_weights = skinned_triangle();
  without_weights.document["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0");
  EXPECT_WARNING(import(without_weights), "its skin is not applied: JOINTS_0 and WEIGHTS_0: are missing");

  GltfBuilder zero = skinned_triangle();
  zero.document["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] =
      zero.accessor(std::vector<float>(12, 0.0F), Float32, "VEC4");
  EXPECT_WARNING(import(zero), "vertex bound to the first joint: its weights have no sum (3 times)");

  // Vertices without weights would be bound to the first joint, which does not exist.
  GltfBuilder no_joints = zero;
  no_joints.document["skins"][0]["joints"] = json::array();
  EXPECT_WARNING(import(no_joints), "its skin is not applied: joints: the skin has none");

  GltfBuilder out_of_range = skinned_triangle();
  out_of_range.document["skins"][0]["joints"] = {1};
  EXPECT_WARNING(import(out_of_range), "its skin is not applied: JOINTS: a joint's index is out of range");

  GltfBuilder short_matrices = skinned_triangle();
  short_matrices.document["skins"][0]["inverseBindMatrices"] =
      short_matrices.accessor(std::vector<float>(16, 0.0F), Float32, "MAT4");
  EXPECT_WARNING(import(short_matrices), "bound at the origin: inverseBindMatrices: has fewer elements");

  // A joint that is above its own mesh, and a mesh whose joint is itself, are allowed: nothing is followed around.
  GltfBuilder self = skinned_triangle();
  self.document["skins"][0]["joints"] = {0, 0};
  import(self);
}

TEST(GltfAnimation, AHundredThousandChannelsAreBounded)
{
  GltfBuilder builder = triangle_scene();
  add_channel(builder, {{"node", 0}, {"path", "translation"}}, {0, 1}, {0, 0, 0, 1, 0, 0}, "VEC3");
  // An accessor of 16 million zeros has no bytes in the file.
  const int zeros = builder.append("accessors", {{"componentType", 5126}, {"count", 1 << 24}, {"type", "SCALAR"}});
  json &animation = builder.document["animations"][0];
  for (int i = 0; i < 100000; i++) {
    if (i % 1000 == 0) {
      animation["samplers"].push_back({{"input", zeros}, {"output", 2}});
    }
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size() - 1 - (i % 2)}, {"target", {{"node", 0}, {"path", "scale"}}}});
  }
  Scene scene = import(builder);
  EXPECT_EQ(scene.animations.at(0).nodes.size(), 1U);
  EXPECT_EQ(position_at(scene, 1.0), glm::dvec3(1, 0, 0));
}

}  // namespace
}  // namespace gnomon
