// SPDX-License-Identifier: MIT
#include "draw_objects.hh"

#include "gpu/gpu_testing.hh"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace gnomon::draw {
namespace {

glm::mat4 random_rotation(std::mt19937 &random)
{
  std::normal_distribution<float> normal;
  const glm::vec3 axis = glm::normalize(glm::vec3(normal(random), normal(random), normal(random)));
  return glm::rotate(glm::mat4(1), 3 * normal(random), axis);
}

float largest_element(const glm::mat3 &matrix)
{
  float largest = 0;
  for (int column = 0; column < 3; column++) {
    for (int row = 0; row < 3; row++) {
      largest = std::max(largest, std::abs(matrix[column][row]));
    }
  }
  return largest;
}

bool is_finite(const glm::mat3 &matrix)
{
  for (int column = 0; column < 3; column++) {
    for (int row = 0; row < 3; row++) {
      if (!std::isfinite(matrix[column][row])) {
        return false;
      }
    }
  }
  return true;
}

/** Matrix of an object: turned, scaled, sheared, mirrored, moved. */
struct Case {
  const char *name;
  glm::vec3 scale;
  float shear;
};

const std::vector<Case> CASES = {
    {"rigid", {1, 1, 1}, 0},
    {"scaled", {2, 0.5F, 3}, 0},
    {"mirrored", {-1, 1, 1}, 0},
    {"mirrored thrice", {-2, -0.5F, -1}, 0},
    {"sheared", {1, 2, 1}, 1.7F},
    {"sheared and mirrored", {1, -2, 1}, -0.8F},
    {"tiny", {1e-4F, 1e-4F, 1e-4F}, 0},
    {"tiny in one direction", {1e-4F, 1, 1}, 0.3F},
    {"huge", {1e5F, 1e5F, 1e5F}, 0},
    {"from small to large", {1e-2F, 1, 1e3F}, 0},
    {"invisibly tiny", {1e-18F, 1e-18F, -1e-18F}, 0},
};

glm::mat4 matrix_of(const Case &one, std::mt19937 &random)
{
  glm::mat4 shear(1);
  shear[1][0] = one.shear;
  shear[2][1] = -one.shear / 2;
  return glm::translate(glm::mat4(1), {100, -50, 3}) * random_rotation(random) * shear *
         glm::scale(glm::mat4(1), one.scale) * random_rotation(random);
}

TEST(NormalMatrix, KeepsNormalsPerpendicularToTheSurfaceAndOutside)
{
  std::mt19937 random(13);
  std::normal_distribution<float> normal;
  for (const Case &one : CASES) {
    SCOPED_TRACE(one.name);
    for (int i = 0; i < 50; i++) {
      const glm::mat4 matrix = matrix_of(one, random);
      const glm::mat3 normals = normal_matrix(matrix);
      EXPECT_NEAR(largest_element(normals), 1, 1e-6F);
      // Normal and tangents of the object, in double: the judge must not round.
      const glm::dvec3 n = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
      const glm::dvec3 u = glm::normalize(glm::cross(n, glm::dvec3(0.3, -0.5, 0.8)));
      const glm::dvec3 v = glm::cross(n, u);
      const glm::dmat3 exact(matrix);
      const glm::dvec3 transformed = glm::dmat3(normals) * n;
      ASSERT_GT(glm::length(transformed), 0);
      // Columns are rounded to floats: the error is a share of the matrix, not of the product.
      const double tolerance = 1e-6 * double(largest_element(normals));
      for (const glm::dvec3 &tangent : {exact * u, exact * v}) {
        EXPECT_NEAR(glm::dot(transformed, glm::normalize(tangent)), 0, tolerance);
      }
      // What stands off the surface outside stays outside, mirrored or not.
      EXPECT_GT(glm::dot(transformed, exact * n), 0);
    }
  }
}

TEST(NormalMatrix, OfARigidObjectIsItsRotation)
{
  std::mt19937 random(17);
  for (int i = 0; i < 20; i++) {
    const glm::mat4 rotation = random_rotation(random);
    const glm::mat3 normals = normal_matrix(glm::translate(glm::mat4(1), {3, 4, 5}) * rotation);
    const float scale = largest_element(glm::mat3(rotation));
    for (int column = 0; column < 3; column++) {
      EXPECT_LT(glm::length(normals[column] * scale - glm::vec3(rotation[column])), 1e-6F);
    }
  }
}

TEST(NormalMatrix, OfAFlattenedObjectIsTheNormalOfItsPlane)
{
  std::mt19937 random(19);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 50; i++) {
    // Two edges span the plane, the third lies in it.
    const glm::vec3 u(normal(random), normal(random), normal(random));
    const glm::vec3 v(normal(random), normal(random), normal(random));
    glm::mat4 matrix(1);
    matrix[0] = glm::vec4(u, 0);
    matrix[1] = glm::vec4(v, 0);
    matrix[2] = i % 2 == 0 ? glm::vec4(0) : glm::vec4(u - v, 0);
    const glm::mat3 normals = normal_matrix(matrix);
    EXPECT_TRUE(is_finite(normals));
    EXPECT_NEAR(largest_element(normals), 1, 1e-6F);
    const glm::vec3 plane = glm::normalize(glm::cross(u, v));
    const glm::vec3 transformed = glm::normalize(normals * glm::vec3(0, 0, 1));
    EXPECT_NEAR(std::abs(glm::dot(transformed, plane)), 1, 1e-5F);
  }
}

TEST(NormalMatrix, OfALineOrAPointIsZeroAndFinite)
{
  for (const glm::vec3 &scale : {glm::vec3(0, 0, 2), glm::vec3(0)}) {
    const glm::mat3 normals = normal_matrix(glm::scale(glm::mat4(1), scale));
    EXPECT_EQ(normals, glm::mat3(0));
  }
}

TEST(IsMirrored, IsTheSignOfTheDeterminant)
{
  std::mt19937 random(23);
  for (const Case &one : CASES) {
    SCOPED_TRACE(one.name);
    for (int i = 0; i < 20; i++) {
      const double product = double(one.scale.x) * double(one.scale.y) * double(one.scale.z);
      EXPECT_EQ(is_mirrored(matrix_of(one, random)), product < 0);
    }
  }
  EXPECT_FALSE(is_mirrored(glm::mat4(1)));
  EXPECT_FALSE(is_mirrored(glm::mat4(0)));
}

TEST(ObjectBuffer, BeginsWithTheIdentity)
{
  ObjectBuffer objects;
  EXPECT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects.add(glm::mat4(2)), 1U);
  EXPECT_EQ(objects.add(glm::mat4(3), 7), 2U);
  objects.clear();
  EXPECT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects.add(glm::mat4(4)), 1U);
}

TEST(ObjectBuffer, UploadIsFreeWhereNothingWasAdded)
{
  const auto device = gpu::create_null_device();
  ObjectBuffer objects;
  EXPECT_FALSE(objects.buffer());
  const auto uploaded = [&] {
    const std::uint64_t before = device->counters().upload_bytes;
    objects.upload(*device);
    return device->counters().upload_bytes - before;
  };
  constexpr std::size_t ENTRY = sizeof(shared::ObjectData);
  EXPECT_EQ(uploaded(), ENTRY);
  EXPECT_EQ(uploaded(), 0U);
  objects.add(glm::mat4(1));
  objects.add(glm::mat4(1));
  EXPECT_EQ(uploaded(), 3 * ENTRY);
  EXPECT_EQ(uploaded(), 0U);
  objects.clear();
  EXPECT_EQ(uploaded(), ENTRY);
}

TEST(ObjectBuffer, GrowsNowAndThenAndNeverShrinks)
{
  const auto device = gpu::create_null_device();
  ObjectBuffer objects;
  std::size_t size_before = 0;
  int growths = 0;
  for (int i = 0; i < 1000; i++) {
    objects.add(glm::mat4(1));
    objects.upload(*device);
    const std::size_t size = objects.buffer().size_bytes();
    EXPECT_GE(size, objects.size() * sizeof(shared::ObjectData));
    EXPECT_GE(size, size_before);
    growths += size > size_before ? 1 : 0;
    size_before = size;
  }
  EXPECT_LE(growths, 12);
  objects.clear();
  objects.upload(*device);
  EXPECT_EQ(objects.buffer().size_bytes(), size_before);
  EXPECT_EQ(device->live_resources().size(), 1U) << "a buffer that was outgrown lives";
}

TEST(ObjectBuffer, TakesAllThatTheLimitHoldsAndNamesItBeyond)
{
  // Eight entries and a little.
  gpu::Limits limits;
  limits.storage_block_bytes_max = 8 * sizeof(shared::ObjectData) + 100;
  const auto device = gpu::create_null_device(limits);
  ObjectBuffer objects;
  objects.upload(*device);
  while (objects.size() < 8) {
    objects.add(glm::mat4(1));
  }
  EXPECT_EQ(test::error_of([&] { objects.upload(*device); }), "");
  objects.add(glm::mat4(1));
  test::expect_contains(test::error_of([&] { objects.upload(*device); }), "buffer 'object_block'");
  EXPECT_TRUE(objects.buffer()) << "what was there is lost";
  // The next try fails too, and after a clear all is well.
  EXPECT_NE(test::error_of([&] { objects.upload(*device); }), "");
  objects.clear();
  EXPECT_EQ(test::error_of([&] { objects.upload(*device); }), "");
}

TEST(ObjectBuffer, MovesToANewDeviceWithItsContent)
{
  ObjectBuffer objects;
  objects.add(glm::mat4(2));
  {
    const auto first = gpu::create_null_device({}, [](std::string_view /*message*/) {});
    objects.upload(*first);
  }
  EXPECT_FALSE(objects.buffer());
  const auto second = gpu::create_null_device();
  objects.upload(*second);
  EXPECT_TRUE(objects.buffer());
  EXPECT_EQ(second->counters().upload_bytes, 2 * sizeof(shared::ObjectData));
}

}  // namespace
}  // namespace gnomon::draw
