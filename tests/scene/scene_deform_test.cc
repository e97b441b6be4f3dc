// SPDX-License-Identifier: MIT
// Edits of deformed meshes. \see gltf_animation_test.cc for the deformation itself
#include "scene.hh"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace gnomon::scene {
namespace {

/** Two squares with tangents, with a joint each, and a morph target. */
class SceneDeformTest : public testing::Test {
 protected:
  SceneDeformTest()
  {
    Mesh shape{.name = "body"};
    for (int i = 0; i < 8; i++) {
      shape.positions.emplace_back(float(i % 2), float(i / 2 % 2), float(i / 4));
      shape.normals.emplace_back(0, 0, 1);
      shape.tangents.emplace_back(1, 0, 0, -1);
    }
    shape.indices = {0, 1, 3, 0, 3, 2, 4, 5, 7, 4, 7, 6};
    mesh = scene.add(shape);
    node = scene.add(Node{.name = "body", .parent_from_node = moved({5, 0, 0}), .meshes = {mesh}});
    joints = {scene.add(Node{.name = "hip"}), scene.add(Node{.name = "knee"})};
    scene.skins.push_back({"skin", joints, {glm::dmat4(1.0), glm::dmat4(1.0)}});
    DeformedMesh deformed;
    deformed.mesh = mesh;
    deformed.node = node;
    deformed.positions = shape.positions;
    deformed.normals = shape.normals;
    deformed.tangents = shape.tangents;
    deformed.targets = {{std::vector<glm::vec3>(8, {0, 0, 0.5F}), std::vector<glm::vec3>(8, {0.5F, 0, 0}),
                         std::vector<glm::vec3>(8, {0, 0.25F, 0})}};
    deformed.weights = {0.0};
    deformed.skin = 0;
    deformed.joint_sets = 1;
    for (int i = 0; i < 8; i++) {
      const float knee = i < 4 ? 0.25F : 1.0F;
      deformed.joint_weights.push_back({{0, 1, 0, 0}, {1.0F - knee, knee, 0, 0}});
    }
    scene.deformed_meshes.push_back(std::move(deformed));
    const auto track = [](std::size_t width, std::vector<float> values) {
      return std::make_shared<const Track>(Track{Interpolation::Linear, width, {0, 1}, std::move(values)});
    };
    const float half = std::sqrt(0.5F);
    AnimatedNode knee;
    knee.node = joints[1];
    knee.translation_track = track(3, {0, 0, 0, 1, 2, 3});
    knee.rotation_track = track(4, {0, 0, 0, 1, half, 0, 0, half});
    knee.scale_track = track(3, {1, 1, 1, 2, 1, 0.5F});
    AnimatedNode body;
    body.node = node;
    body.weights_track = track(1, {0, 1});
    scene.animations.push_back({"walk", {knee, body}, {}});
  }
  static glm::dmat4 moved(const glm::dvec3 &way)
  {
    return glm::translate(glm::dmat4(1.0), way);
  }
  void pose_at(double seconds)
  {
    pose(scene, scene.animations[0], seconds);
  }
  [[nodiscard]] const Mesh &shown() const
  {
    return scene.meshes()[mesh];
  }
  /** The message of pose(); empty if it throws nothing. */
  std::string fault_at(double seconds)
  {
    try {
      pose_at(seconds);
    }
    catch (const InvalidEdit &error) {
      return error.what();
    }
    return {};
  }
  template <typename Vector>
  static double distance(const std::vector<Vector> &a, const std::vector<Vector> &b)
  {
    EXPECT_EQ(a.size(), b.size());
    double largest = 0.0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); i++) {
      largest = std::max(largest, double(glm::length(a[i] - b[i])));
    }
    return largest;
  }

  Scene scene;
  Handle<Mesh> mesh;
  Handle<Node> node;
  std::vector<Handle<Node>> joints;
};

/** An edit in any pose is the edit that gives the same mesh in all other poses, wherever it was made. */
TEST_F(SceneDeformTest, AnEditIsPosedWithTheRest)
{
  const std::vector<std::function<void(Mesh &)>> edits = {
      [](Mesh &edited) { edited.positions[6] += glm::vec3(0.5F, -0.25F, 1.0F); },
      [](Mesh &edited) { edited.normals[1] = glm::normalize(glm::vec3(1, 2, 3)); },
      [](Mesh &edited) {
        edited.tangents[7] = {glm::normalize(glm::vec3(1, -2, 3)), 1};
      },
      [](Mesh &edited) {
        for (glm::vec3 &position : edited.positions) {
          position *= 2.0F;
        }
      },
      [](Mesh &edited) { edited.tangents.clear(); },
      [](Mesh &edited) {
        edited.uvs.assign(8, {0.5F, 0.5F});
      },
      [](Mesh &edited) { edited.indices.resize(3); },
  };
  for (const double at : {0.0, 0.4, 1.0}) {
    for (std::size_t i = 0; i < edits.size(); i++) {
      SCOPED_TRACE(testing::Message() << "edit " << i << " at " << at);
      const Scene original = scene;
      pose_at(at);
      scene.edit(mesh, edits[i]);
      const Mesh edited = shown();
      pose_at(at);
      EXPECT_EQ(shown().positions, edited.positions) << "the same pose";
      for (const double elsewhere : {1.0, 0.7, 0.0}) {
        pose_at(elsewhere);
      }
      pose_at(at);
      EXPECT_LT(distance(shown().positions, edited.positions), 5e-6);
      EXPECT_LT(distance(shown().normals, edited.normals), 2e-6);
      EXPECT_LT(distance(shown().tangents, edited.tangents), 2e-6);
      EXPECT_EQ(shown().uvs, edited.uvs);
      EXPECT_EQ(shown().indices, edited.indices);
      scene = original;
    }
  }
  // At rest, the edit is the new rest shape, bit for bit.
  pose_at(0.0);
  scene.edit(mesh, edits[0]);
  EXPECT_EQ(scene.deformed_meshes[0].positions[6], shown().positions[6] + glm::vec3(5, 0, 0));
  EXPECT_EQ(scene.deformed_meshes[0].positions[5], glm::vec3(1, 0, 1));
}

TEST_F(SceneDeformTest, AnEditOfSomeVerticesIsOneOfTheWholeMesh)
{
  Scene other = scene;
  const glm::vec3 moved = scene.meshes()[mesh].positions[2] + glm::vec3(0.25F);
  const std::uint32_t vertex = 2;
  scene.set_vertices(mesh, {.vertices = {&vertex, 1}, .positions = {&moved, 1}});
  other.edit(mesh, [&](Mesh &edited) { edited.positions[2] = moved; });
  EXPECT_EQ(scene.deformed_meshes[0].positions, other.deformed_meshes[0].positions);
  EXPECT_EQ(scene.meshes()[mesh].positions, other.meshes()[mesh].positions);
}

TEST_F(SceneDeformTest, APoseWritesOnlyWhatItChanges)
{
  scene.edit(mesh, [](Mesh &edited) {
    edited.uvs.assign(8, {0.25F, 0.75F});
    edited.colors.assign(8, glm::vec4(0.5F));
  });
  const Mesh before = shown();
  const void *uvs = shown().uvs.data();
  const void *colors = shown().colors.data();
  const auto revision_of = [&](Mesh::Aspect aspect) { return scene.meshes().revision(mesh, aspect); };
  const Revision seen = scene.revision();
  pose_at(0.5);
  EXPECT_GT(distance(shown().positions, before.positions), 0.1);
  EXPECT_EQ(shown().uvs.data(), uvs);
  EXPECT_EQ(shown().colors.data(), colors);
  EXPECT_EQ(shown().uvs, before.uvs);
  EXPECT_EQ(shown().colors, before.colors);
  EXPECT_EQ(shown().indices, before.indices);
  Bounds bounds;
  for (const glm::vec3 &position : shown().positions) {
    bounds.extend(position);
  }
  EXPECT_EQ(shown().bounds, bounds);
  EXPECT_GT(revision_of(Mesh::Aspect::Shape), seen);
  for (const Mesh::Aspect aspect : {Mesh::Aspect::Name, Mesh::Aspect::Layout, Mesh::Aspect::Material}) {
    EXPECT_LE(revision_of(aspect), seen) << int(aspect);
  }
}

TEST_F(SceneDeformTest, APoseThatIsNotFiniteIsAnErrorThatNamesTheStream)
{
  pose_at(0.5);
  const Mesh before = shown();
  const Revision seen = scene.revision();
  scene.deformed_meshes[0].positions[5].y = INFINITY;
  EXPECT_EQ(fault_at(1.0), "mesh 'body': position 5 is not finite");
  EXPECT_EQ(shown().positions, before.positions);
  EXPECT_EQ(shown().normals, before.normals);
  EXPECT_EQ(shown().bounds, before.bounds);
  EXPECT_LE(scene.meshes().revision(mesh, Mesh::Aspect::Shape), seen);
}

TEST_F(SceneDeformTest, AnEditBeforeTheFirstPoseIsOneOfTheRestShape)
{
  scene.edit(mesh, [](Mesh &edited) { edited.positions[6] = {9, 9, 9}; });
  pose_at(0.0);
  EXPECT_EQ(shown().positions[6], glm::vec3(4, 9, 9)) << "relative to the node, which is at x = 5";
}

TEST_F(SceneDeformTest, VerticesThatDifferFromTheRestShapeAreAnErrorThatNamesTheMesh)
{
  pose_at(0.5);
  const Mesh original = shown();
  for (const std::size_t count : {3, 7, 9, 100000}) {
    Mesh changed = original;
    changed.positions.resize(count, {1, 2, 3});
    changed.normals.resize(count, {0, 0, 1});
    changed.tangents.clear();
    changed.indices.assign(3, std::uint32_t(count - 1));
    scene.replace(mesh, changed);
    const Revision before = scene.revision();
    const std::string message = fault_at(0.75);
    EXPECT_NE(message.find("mesh 'body'"), std::string::npos) << message;
    EXPECT_NE(message.find(std::to_string(count) + " positions"), std::string::npos) << message;
    EXPECT_EQ(scene.revision(), before) << "nothing is posed";
    EXPECT_THROW(deform_meshes(scene), InvalidEdit);
  }
  // With the old number of vertices it is posed again, with the new positions.
  Mesh back = original;
  back.positions[6] = {3, 2, 1};
  scene.replace(mesh, back);
  pose_at(0.1);
  pose_at(0.5);
  EXPECT_LT(distance(shown().positions, back.positions), 5e-6);
  // Without its rest shape, it is a mesh like any other.
  scene.edit(mesh, [](Mesh &edited) {
    edited.positions.push_back({7, 7, 7});
    edited.normals.push_back({0, 0, 1});
    edited.tangents.clear();
  });
  scene.deformed_meshes.clear();
  pose_at(0.9);
  EXPECT_EQ(shown().positions.back(), glm::vec3(7, 7, 7));
}

TEST_F(SceneDeformTest, AHostsRestShapeThatDoesNotFitIsAnErrorThatNamesTheMesh)
{
  const std::vector<std::pair<const char *, std::function<void(DeformedMesh &)>>> faults = {
      {"normals", [](DeformedMesh &deformed) { deformed.normals.pop_back(); }},
      {"tangents", [](DeformedMesh &deformed) { deformed.tangents.pop_back(); }},
      {"weights", [](DeformedMesh &deformed) { deformed.weights.clear(); }},
      {"skin 9", [](DeformedMesh &deformed) { deformed.skin = 9; }},
      {"joint weights", [](DeformedMesh &deformed) { deformed.joint_weights.pop_back(); }},
      {"joint weights", [](DeformedMesh &deformed) { deformed.joint_sets = 2; }},
      {"joint 77", [](DeformedMesh &deformed) { deformed.joint_weights[3].joints[1] = 77; }},
      {"not finite", [](DeformedMesh &deformed) { deformed.positions[2].x = INFINITY; }},
  };
  const DeformedMesh original = scene.deformed_meshes[0];
  for (const auto &[word, change] : faults) {
    scene.deformed_meshes[0] = original;
    change(scene.deformed_meshes[0]);
    for (int round = 0; round < 2; round++) {
      const std::string message = fault_at(0.3);
      EXPECT_NE(message.find("mesh 'body'"), std::string::npos) << word << ": " << message;
      EXPECT_NE(message.find(word), std::string::npos) << word << ": " << message;
    }
  }
  scene.deformed_meshes[0] = original;
  scene.skins[0].joint_from_mesh.pop_back();
  EXPECT_NE(fault_at(0.3).find("mesh 'body'"), std::string::npos);
}

TEST_F(SceneDeformTest, WhatJointsFlattenCannotBeMoved)
{
  scene.edit(joints[1], [](Node &edited) { edited.parent_from_node = glm::scale(glm::dmat4(1.0), {1, 0, 1}); });
  deform_meshes(scene);
  scene.edit(mesh, [](Mesh &edited) { edited.positions[0].y = 3.0F; });
  EXPECT_THROW(scene.edit(mesh, [](Mesh &edited) { edited.positions[4].x = 3.0F; }), InvalidEdit);
  scene.edit(mesh, [](Mesh &edited) { edited.uvs.assign(8, {0, 0}); });
}

TEST_F(SceneDeformTest, FlatNormalsFollowThePositionsUntilTheyAreReplaced)
{
  scene.skins.clear();
  DeformedMesh &deformed = scene.deformed_meshes[0];
  deformed.skin = -1;
  deformed.has_flat_normals = true;
  // No two triangles share a vertex.
  scene.edit(mesh, [](Mesh &edited) { edited.indices = {0, 1, 3, 4, 5, 7}; });
  scene.edit(mesh, [](Mesh &edited) {
    edited.positions[5].z = 2.0F;
    for (const int corner : {4, 5, 7}) {
      edited.normals[std::size_t(corner)] = glm::normalize(
          glm::cross(edited.positions[5] - edited.positions[4], edited.positions[7] - edited.positions[4]));
    }
  });
  EXPECT_TRUE(deformed.has_flat_normals);
  pose_at(0.5);
  const Mesh &now = shown();
  const glm::vec3 flat =
      glm::normalize(glm::cross(now.positions[5] - now.positions[4], now.positions[7] - now.positions[4]));
  EXPECT_LT(glm::length(now.normals[5] - flat), 1e-6F);
  EXPECT_LT(glm::length(now.positions[5] - glm::vec3(1, 0, 2.25F)), 1e-6F);
  scene.edit(mesh, [](Mesh &edited) { edited.normals[5] = {0, 1, 0}; });
  EXPECT_FALSE(deformed.has_flat_normals);
  const std::vector<glm::vec3> normals = shown().normals;
  pose_at(0.0);
  pose_at(0.5);
  EXPECT_LT(distance(shown().normals, normals), 1e-6) << "those that were flat stay as they are seen";
}

TEST_F(SceneDeformTest, ARestoredJointMovesTheMeshAgain)
{
  pose_at(1.0);
  const Mesh before = shown();
  const Node joint = scene.nodes()[joints[1]];
  scene.remove(joints[1]);
  pose_at(0.5);
  EXPECT_GT(distance(shown().positions, before.positions), 0.1);
  scene.restore(joints[1], joint);
  pose_at(1.0);
  EXPECT_EQ(shown().positions, before.positions);
}

}  // namespace
}  // namespace gnomon::scene
