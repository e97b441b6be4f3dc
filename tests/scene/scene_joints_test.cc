// SPDX-License-Identifier: MIT
#include "scene_joints.hh"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <utility>
#include <vector>

namespace gnomon::scene {
namespace {

/** A floor of 4 x 4 m at a height of 0, and a wall above its edge at z = -2 that is 1 m longer on both sides. */
class CloseJointsTest : public testing::Test {
 protected:
  static Mesh quad(const std::vector<glm::vec3> &corners)
  {
    Mesh mesh;
    mesh.positions = corners;
    mesh.normals.assign(4, glm::normalize(glm::cross(corners[1] - corners[0], corners[3] - corners[0])));
    mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
  }
  static Mesh floor(float height = 0.0F)
  {
    return quad({{-2, height, 2}, {2, height, 2}, {2, height, -2}, {-2, height, -2}});
  }
  static Mesh wall()
  {
    return quad({{-3, 0, -2}, {3, 0, -2}, {3, 2, -2}, {-3, 2, -2}});
  }
  Handle<Mesh> add(Mesh mesh, const glm::dmat4 &world_from_object = glm::dmat4(1.0))
  {
    const Handle<Mesh> handle = scene.add(std::move(mesh));
    Node node;
    node.meshes = {handle};
    node.parent_from_node = world_from_object;
    scene.add(node);
    return handle;
  }
  [[nodiscard]] std::size_t triangle_count(Handle<Mesh> mesh) const
  {
    return scene.meshes()[mesh].indices.size() / 3;
  }
  /** Sum of the areas of triangles that face as their first vertex's normal. */
  [[nodiscard]] double facing_area(Handle<Mesh> handle) const
  {
    const Mesh &mesh = scene.meshes()[handle];
    double area = 0.0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const auto corner = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[i + k]]); };
      area += 0.5 * glm::dot(glm::cross(corner(1) - corner(0), corner(2) - corner(0)),
                             glm::dvec3(mesh.normals[mesh.indices[i]]));
    }
    return area;
  }

  Scene scene;
};

TEST_F(CloseJointsTest, SplitTheEdgeAtTheVerticesOnIt)
{
  const Handle<Mesh> ground = add(floor());
  const Handle<Mesh> side = add(wall());
  close_joints(scene);
  EXPECT_EQ(triangle_count(ground), 2);
  // The lower edge has the two corners of the floor.
  EXPECT_EQ(triangle_count(side), 4);
  EXPECT_DOUBLE_EQ(facing_area(side), 12.0);
  const Mesh &mesh = scene.meshes()[side];
  for (const float x : {-2.0F, 2.0F}) {
    const auto found = std::ranges::find(mesh.positions, glm::vec3(x, 0, -2));
    ASSERT_NE(found, mesh.positions.end());
    const std::size_t vertex = std::size_t(found - mesh.positions.begin());
    EXPECT_EQ(mesh.normals[vertex], glm::vec3(0, 0, 1));
    EXPECT_NEAR(mesh.uvs[vertex].x, (x + 3.0F) / 6.0F, 1e-6);
    EXPECT_EQ(mesh.uvs[vertex].y, 1.0F);
  }

  const Revision closed = scene.revision();
  close_joints(scene);
  EXPECT_EQ(scene.revision(), closed);
}

TEST_F(CloseJointsTest, InTransformedObjects)
{
  const glm::dmat4 place = glm::rotate(glm::translate(glm::dmat4(1.0), {300, 20, -70}), 0.7, {1, 2, 3});
  const Handle<Mesh> ground = add(floor(), place);
  const Handle<Mesh> side = add(wall(), place);
  // A partition from the edge of the floor, whose lower corner lies on the floor's edge at x = 2, below a node with
  // another scale.
  Mesh half = quad({{1, 0, 0}, {1, 0, -1}, {1, 0.5F, -1}, {1, 0.5F, 0}});
  const glm::dmat4 twice = place * glm::scale(glm::dmat4(1.0), glm::dvec3(2.0));
  add(half, twice);
  close_joints(scene);
  EXPECT_EQ(triangle_count(side), 4);
  EXPECT_EQ(triangle_count(ground), 3);
  const std::vector<glm::vec3> &positions = scene.meshes()[ground].positions;
  EXPECT_LE(glm::distance(positions.back(), glm::vec3(2, 0, 0)), 1e-6F);
}

TEST_F(CloseJointsTest, LeaveGapsClosedBodiesAndOtherMaterials)
{
  add(floor(1e-5F));
  add(wall());
  // A tetrahedron with an edge within the floor's edge at z = 2: its own edges have two triangles, those of the floor
  // one.
  Mesh body;
  body.positions = {{-3, 5, 2}, {3, 5, 2}, {0, 6, 2}, {0, 5, 3}};
  body.normals.assign(4, {0, 1, 0});
  body.indices = {0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0};
  add(body);
  for (glm::vec3 &position : body.positions) {
    position.x *= 0.5F;
  }
  add(body);
  Material mask;
  mask.alpha_mode = AlphaMode::Mask;
  Mesh leaf = quad({{-2, 0, -2}, {2, 0, -2}, {2, 1, -2}, {-2, 1, -2}});
  leaf.material = scene.add(mask);
  add(leaf);
  const Revision before = scene.revision();
  close_joints(scene);
  EXPECT_EQ(scene.revision(), before);
}

TEST_F(CloseJointsTest, SplitAnEdgeAtThousandsOfVertices)
{
  constexpr std::uint32_t count = 4000;
  Mesh fence;
  for (std::uint32_t i = 0; i <= count; i++) {
    for (const float height : {0.0F, 1.0F}) {
      fence.positions.emplace_back(-2.0F + 4.0F * float(i) / float(count), height, -2.0F);
      fence.normals.emplace_back(0, 0, 1);
    }
    for (const std::uint32_t corner : {0U, 2U, 3U, 0U, 3U, 1U}) {
      if (i < count) {
        fence.indices.push_back(2 * i + corner);
      }
    }
  }
  const Handle<Mesh> ground = add(floor());
  add(fence);
  close_joints(scene);
  EXPECT_EQ(triangle_count(ground), 2 + count - 1);
  EXPECT_NEAR(facing_area(ground), 16.0, 1e-5);
}

/** With more pairs of vertices and edges in one place than there may be, the search ends at once and edits nothing. */
TEST_F(CloseJointsTest, EndInCrowds)
{
  Mesh crowd = floor();
  for (std::uint32_t i = 0; i < 2000; i++) {
    const auto first = std::uint32_t(crowd.positions.size());
    for (const glm::vec3 &corner : {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 0, 1)}) {
      crowd.positions.push_back(1e-3F * corner + glm::vec3(0, 1e-5F * float(i), 0));
      crowd.normals.emplace_back(0, 1, 0);
      crowd.uvs.emplace_back(0, 0);
      crowd.indices.push_back(first + std::uint32_t(crowd.indices.size() % 3));
    }
  }
  const Handle<Mesh> ground = add(crowd);
  const Handle<Mesh> side = add(wall());
  close_joints(scene);
  EXPECT_EQ(triangle_count(ground), 2002);
  EXPECT_EQ(triangle_count(side), 2);
}

}  // namespace
}  // namespace gnomon::scene
