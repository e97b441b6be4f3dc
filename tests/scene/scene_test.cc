// SPDX-License-Identifier: MIT
#include "scene.hh"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/vec4.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace gnomon::scene {
namespace {

TEST(Bounds, StartEmptyAndGrow)
{
  Bounds bounds;
  EXPECT_TRUE(bounds.is_empty());
  EXPECT_EQ(bounds.radius(), 0.0F);
  bounds.extend(glm::vec3(1, 2, 3));
  EXPECT_FALSE(bounds.is_empty());
  EXPECT_EQ(bounds.radius(), 0.0F);
  bounds.extend(glm::vec3(-1, 4, 3));
  EXPECT_EQ(bounds.min, glm::vec3(-1, 2, 3));
  EXPECT_EQ(bounds.max, glm::vec3(1, 4, 3));
  EXPECT_EQ(bounds.center(), glm::vec3(0, 3, 3));
  EXPECT_FLOAT_EQ(bounds.radius(), std::sqrt(2.0F));
}

TEST(Bounds, ExtendByEmptyChangesNothing)
{
  Bounds bounds{{0, 0, 0}, {1, 1, 1}};
  bounds.extend(Bounds());
  EXPECT_EQ(bounds.min, glm::vec3(0));
  EXPECT_EQ(bounds.max, glm::vec3(1));
}

TEST(Bounds, TransformIsTheBoxOfTheCorners)
{
  const Bounds box{{-1, 0, 2}, {3, 0.5F, 4}};
  glm::mat4 matrix = glm::rotate(glm::translate(glm::mat4(1), {5, -2, 1}), 0.7F, glm::normalize(glm::vec3(1, 2, -3)));
  matrix = glm::scale(matrix, {2, -1, 0.5F});
  Bounds expected;
  for (int corner = 0; corner < 8; corner++) {
    const glm::vec3 point((corner & 1) != 0 ? box.max.x : box.min.x, (corner & 2) != 0 ? box.max.y : box.min.y,
                          (corner & 4) != 0 ? box.max.z : box.min.z);
    expected.extend(glm::vec3(matrix * glm::vec4(point, 1)));
  }
  const Bounds result = transformed(box, matrix);
  for (int axis = 0; axis < 3; axis++) {
    EXPECT_NEAR(result.min[axis], expected.min[axis], 1e-5F);
    EXPECT_NEAR(result.max[axis], expected.max[axis], 1e-5F);
  }
}

TEST(Bounds, TransformOfEmptyIsEmpty)
{
  EXPECT_TRUE(transformed(Bounds(), glm::scale(glm::mat4(1), glm::vec3(-2))).is_empty());
}

TEST(Scene, BoundsAreThoseOfItsObjects)
{
  Scene scene;
  EXPECT_TRUE(scene.bounds().is_empty());
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 1, 1}};
  mesh.normals.assign(2, {0, 0, 1});
  const Handle<Mesh> handle = scene.add(std::move(mesh));
  Node node;
  node.meshes = {handle};
  scene.add(node);
  node.parent_from_node = glm::translate(glm::dmat4(1), {10, 0, -5});
  scene.add(node);
  EXPECT_EQ(scene.bounds().min, glm::vec3(0, 0, -5));
  EXPECT_EQ(scene.bounds().max, glm::vec3(11, 1, 1));
}

}  // namespace
}  // namespace gnomon::scene
