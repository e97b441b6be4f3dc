// SPDX-License-Identifier: MIT
#include "scene_tangents.hh"

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include <cmath>
#include <numbers>

namespace gnomon::scene {
namespace {

/** A square from -1 to 1 that faces +Z, with uvs by \a uv_of of a position. */
template <typename UvOf>
Mesh square(UvOf &&uv_of)
{
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  for (const glm::vec3 &position : mesh.positions) {
    mesh.uvs.push_back(uv_of(position));
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

void expect_all(const Mesh &mesh, const glm::vec4 &expected)
{
  ASSERT_EQ(mesh.tangents.size(), mesh.positions.size());
  for (const glm::vec4 &tangent : mesh.tangents) {
    EXPECT_LE(glm::length(tangent - expected), 1e-6F) << tangent.x << ' ' << tangent.y << ' ' << tangent.w;
  }
}

TEST(Tangents, PointAlongUAndTheirSignUpTheImage)
{
  Mesh upright = square([](const glm::vec3 &p) { return glm::vec2(p.x, -p.y); });
  make_tangents(upright, {});
  expect_all(upright, {1, 0, 0, 1});
  Mesh mirrored = square([](const glm::vec3 &p) { return glm::vec2(-p.x, -p.y); });
  make_tangents(mirrored, {});
  expect_all(mirrored, {-1, 0, 0, -1});
  Mesh sheared = square([](const glm::vec3 &p) { return glm::vec2(p.x + p.y, -p.y); });
  make_tangents(sheared, {});
  expect_all(sheared, {1, 0, 0, 1});
}

TEST(Tangents, FollowTheTransformOfTheTexture)
{
  // The image is rotated by 90 degrees counter-clockwise: u points up on the square.
  Mesh mesh = square([](const glm::vec3 &p) { return glm::vec2(p.x, -p.y); });
  TextureSlot slot;
  slot.rotation = -std::numbers::pi_v<float> / 2;
  make_tangents(mesh, slot);
  const glm::dmat3x2 uv_from_mesh = slot.uv_from_mesh();
  const glm::dvec2 along = uv_from_mesh * glm::dvec3(0, -1, 0);
  expect_all(mesh, {0, along.x > 0 ? 1 : -1, 0, 1});
}

/** The direction of increasing longitude is the tangent, orthogonal to the normal. */
TEST(Tangents, OfASphereFollowItsParallels)
{
  constexpr int columns = 32;
  constexpr int rows = 16;
  Mesh mesh;
  for (int row = 0; row <= rows; row++) {
    for (int column = 0; column <= columns; column++) {
      const float u = float(column) / columns;
      const float v = float(row) / rows;
      const float longitude = 2 * std::numbers::pi_v<float> * u;
      const float latitude = std::numbers::pi_v<float> * (0.5F - v);
      mesh.positions.emplace_back(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                                  std::sin(latitude));
      mesh.normals.push_back(mesh.positions.back());
      mesh.uvs.emplace_back(u, v);
    }
  }
  for (int row = 1; row < rows - 1; row++) {
    for (int column = 0; column < columns; column++) {
      const auto at = [&](int x, int y) { return std::uint32_t((row + y) * (columns + 1) + column + x); };
      mesh.indices.insert(mesh.indices.end(), {at(0, 0), at(0, 1), at(1, 1), at(0, 0), at(1, 1), at(1, 0)});
    }
  }
  make_tangents(mesh, {});
  for (const std::uint32_t i : mesh.indices) {
    const glm::vec3 tangent(mesh.tangents[i]);
    const glm::vec3 along = glm::normalize(glm::vec3(-mesh.positions[i].y, mesh.positions[i].x, 0));
    EXPECT_NEAR(glm::dot(tangent, mesh.normals[i]), 0, 1e-6);
    EXPECT_NEAR(glm::length(tangent), 1, 1e-6);
    // The triangles of a quad are not symmetric about its meridian; at the seam only one side contributes.
    EXPECT_GT(glm::dot(tangent, along), std::cos(0.11));
    EXPECT_EQ(mesh.tangents[i].w, 1.0F);
  }
}

TEST(Tangents, AVertexBetweenAnImageAndItsMirrorImageIsSplit)
{
  // u increases towards the line x = 0 from both sides.
  Mesh mesh;
  mesh.positions = {{-1, 0, 0}, {0, 0, 0}, {0, 1, 0}, {1, 0, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 1}};
  mesh.colors = {glm::vec4(0.1F), glm::vec4(0.2F), glm::vec4(0.3F), glm::vec4(0.4F)};
  mesh.indices = {0, 1, 2, 1, 3, 2};
  make_tangents(mesh, {});
  ASSERT_EQ(mesh.positions.size(), 6U);
  for_each_stream(mesh, [](const auto &stream) { EXPECT_EQ(stream.size(), 6U); });
  for (int corner = 0; corner < 3; corner++) {
    EXPECT_EQ(mesh.tangents[mesh.indices[corner]], glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(mesh.tangents[mesh.indices[3 + corner]], glm::vec4(-1, 0, 0, -1));
  }
  EXPECT_EQ(mesh.colors[mesh.indices[3]], glm::vec4(0.2F));
}

TEST(Tangents, WithoutAnAreaInTheImageAreFinite)
{
  Mesh mesh = square([](const glm::vec3 &) { return glm::vec2(0.5F); });
  make_tangents(mesh, {});
  for (const glm::vec4 &tangent : mesh.tangents) {
    EXPECT_NEAR(glm::length(glm::vec3(tangent)), 1, 1e-6);
    EXPECT_NEAR(tangent.z, 0, 1e-6);
  }
}

}  // namespace
}  // namespace gnomon::scene
