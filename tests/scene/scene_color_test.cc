// SPDX-License-Identifier: MIT
#include "scene.hh"

#include <gtest/gtest.h>

namespace gnomon::scene {
namespace {

Mesh colored_triangle()
{
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals.assign(3, {0, 0, 1});
  mesh.colors.assign(3, glm::vec4(0.5F));
  mesh.indices = {0, 1, 2};
  return mesh;
}

TEST(SceneMeshColors, ChangedColoursChangeTheShapeAspect)
{
  Scene scene;
  const Handle<Mesh> handle = scene.add(colored_triangle());
  const Revision before = scene.meshes().revision(handle, Mesh::Aspect::Shape);
  scene.replace(handle, colored_triangle());
  EXPECT_EQ(scene.meshes().revision(handle, Mesh::Aspect::Shape), before);
  scene.edit(handle, [](Mesh &mesh) { mesh.colors[2].w = 1.0F; });
  EXPECT_GT(scene.meshes().revision(handle, Mesh::Aspect::Shape), before);
}

TEST(SceneMeshColors, AreNoneOrOneForEachPosition)
{
  Scene scene;
  Mesh mesh = colored_triangle();
  mesh.colors.pop_back();
  EXPECT_THROW(scene.add(mesh), InvalidEdit);
  mesh.colors.clear();
  EXPECT_NO_THROW(scene.add(mesh));
}

}  // namespace
}  // namespace gnomon::scene
