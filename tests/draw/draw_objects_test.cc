// SPDX-License-Identifier: MIT
#include "draw_objects.hh"

#include "gpu/gpu_testing.hh"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
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
      // Normal and tangents of the object, in double, whose rounding is far below the tolerance.
      const glm::dvec3 n = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
      const glm::dvec3 u = glm::normalize(glm::cross(n, glm::dvec3(0.3, -0.5, 0.8)));
      const glm::dvec3 v = glm::cross(n, u);
      const glm::dmat3 exact(matrix);
      const glm::dvec3 transformed = glm::dmat3(normals) * n;
      ASSERT_GT(glm::length(transformed), 0);
      // Columns are rounded to float: the error is relative to the matrix, not to the product.
      const double tolerance = 1e-6 * double(largest_element(normals));
      for (const glm::dvec3 &tangent : {exact * u, exact * v}) {
        EXPECT_NEAR(glm::dot(transformed, glm::normalize(tangent)), 0, tolerance);
      }
      // A point outside of the surface remains outside, mirrored or not.
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
    // Two edges span the plane, which contains the third.
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

TEST(IsMirrored, OfAnObjectFollowsItsMatrix)
{
  const glm::mat4 plain(1.0F);
  const glm::mat4 mirrored = glm::scale(plain, glm::vec3(1, -1, 1));
  ObjectBuffer objects;
  EXPECT_FALSE(objects.is_mirrored(object_identity));
  const ObjectIndex object = objects.add(mirrored);
  EXPECT_TRUE(objects.is_mirrored(object));
  objects.set(object, plain, 0, {});
  EXPECT_FALSE(objects.is_mirrored(object));
  objects.remove(object);
  ASSERT_EQ(objects.add(mirrored), object);
  EXPECT_TRUE(objects.is_mirrored(object));
}

constexpr std::size_t ENTRY_BYTES = sizeof(shared::ObjectData);

/** Bytes that an upload of \a objects writes. */
std::uint64_t uploaded_bytes(ObjectBuffer &objects, gpu::Device &device)
{
  const std::uint64_t before = device.counters().upload_bytes;
  objects.upload(device);
  return device.counters().upload_bytes - before;
}

TEST(ObjectBuffer, BeginsWithTheIdentity)
{
  ObjectBuffer objects;
  EXPECT_EQ(objects.size(), 1U);
  EXPECT_EQ(objects.world_from_object(object_identity), glm::mat4(1));
  EXPECT_EQ(objects.add(glm::mat4(2)), 1U);
  EXPECT_EQ(objects.add(glm::mat4(3), 7), 2U);
  EXPECT_EQ(objects.size(), 3U);
  EXPECT_EQ(objects.index_end(), 3U);
}

TEST(ObjectBuffer, IndicesStayAndThatOfARemovedObjectIsUsedAgain)
{
  ObjectBuffer objects;
  for (int i = 1; i <= 5; i++) {
    objects.add(glm::mat4(float(i)), 0, {glm::vec3(float(i)), 1});
  }
  objects.remove(2);
  objects.remove(4);
  EXPECT_EQ(objects.size(), 4U);
  for (const ObjectIndex index : {1U, 3U, 5U}) {
    EXPECT_TRUE(objects.is_live(index));
    EXPECT_EQ(objects.world_from_object(index), glm::mat4(float(index)));
    EXPECT_EQ(objects.volume(index).center_ws, glm::vec3(float(index)));
  }
  EXPECT_FALSE(objects.is_live(2));
  EXPECT_FALSE(objects.is_live(4));
  EXPECT_FALSE(objects.is_live(6)) << "an index that was never given";
  std::vector<ObjectIndex> again = {objects.add(glm::mat4(6)), objects.add(glm::mat4(7))};
  std::ranges::sort(again);
  EXPECT_EQ(again, (std::vector<ObjectIndex>{2, 4}));
  EXPECT_EQ(objects.add(glm::mat4(8)), 6U);
}

TEST(ObjectBuffer, RevisionsTellWhatChanged)
{
  ObjectBuffer objects;
  const CullingVolume volume{{1, 2, 3}, 4};
  const ObjectIndex a = objects.add(glm::mat4(2), 5, volume);
  const ObjectIndex b = objects.add(glm::mat4(3), 6, volume);
  EXPECT_GT(objects.revision(b), objects.revision(a));
  const auto is_edit = [&](ObjectIndex index, auto &&change) {
    const std::uint64_t before = objects.revision();
    const std::uint64_t structure = objects.structure_revision();
    change();
    EXPECT_EQ(objects.structure_revision(), structure) << "nothing was added or removed";
    EXPECT_EQ(objects.revision() > before, objects.revision(index) > before);
    return objects.revision() > before;
  };
  EXPECT_FALSE(is_edit(a, [&] { objects.set(a, glm::mat4(2), 5, volume); })) << "the same values";
  EXPECT_TRUE(is_edit(a, [&] { objects.set(a, glm::mat4(9), 5, volume); }));
  EXPECT_TRUE(is_edit(a, [&] { objects.set(a, glm::mat4(9), 7, volume); }));
  EXPECT_TRUE(is_edit(a, [&] { objects.set(a, glm::mat4(9), 7, {{1, 2, 3}, 5}); }));
  EXPECT_TRUE(is_edit(a, [&] { objects.set(a, glm::mat4(9), 7, {{1, 2, 4}, 5}); }));
  EXPECT_LT(objects.revision(b), objects.revision(a));
  const std::uint64_t structure = objects.structure_revision();
  objects.remove(b);
  EXPECT_GT(objects.structure_revision(), structure);
  EXPECT_EQ(objects.structure_revision(), objects.revision());
  EXPECT_EQ(objects.revision(b), 0U);
}

TEST(ObjectBuffer, RefusesWhatIsNotFiniteAndIsAsBefore)
{
  constexpr float NAN_VALUE = std::numeric_limits<float>::quiet_NaN();
  constexpr float INFINITE = std::numeric_limits<float>::infinity();
  const CullingVolume volume{{1, 2, 3}, 4};
  ObjectBuffer objects;
  const ObjectIndex index = objects.add(glm::mat4(2), 5, volume);
  const std::uint64_t revision = objects.revision();
  struct Refused {
    glm::mat4 matrix;
    CullingVolume volume;
    const char *reason;
  };
  std::vector<Refused> refused;
  for (const float value : {NAN_VALUE, INFINITE, -INFINITE}) {
    for (int element = 0; element < 16; element++) {
      glm::mat4 matrix(1);
      matrix[element / 4][element % 4] = value;
      refused.push_back({matrix, volume, "matrix is not finite"});
    }
  }
  refused.push_back({glm::mat4(1), {{1, NAN_VALUE, 3}, 4}, "volume is not a number"});
  refused.push_back({glm::mat4(1), {{1, 2, 3}, NAN_VALUE}, "volume is not a number"});
  for (const Refused &one : refused) {
    test::expect_contains(test::error_of([&] { objects.set(index, one.matrix, 6, one.volume); }), one.reason);
    test::expect_contains(test::error_of([&] { objects.add(one.matrix, 6, one.volume); }), one.reason);
  }
  EXPECT_EQ(objects.size(), 2U);
  EXPECT_EQ(objects.revision(), revision);
  EXPECT_EQ(objects.world_from_object(index), glm::mat4(2));
  EXPECT_EQ(objects.volume(index).radius, 4);
  // The index of a removed object is reused.
  objects.remove(index);
  EXPECT_NE(test::error_of([&] { objects.add(glm::mat4(NAN_VALUE)); }), "");
  EXPECT_EQ(objects.add(glm::mat4(1)), index);
}

TEST(ObjectBuffer, UploadsWhatChanged)
{
  const auto device = gpu::create_null_device();
  ObjectBuffer objects;
  EXPECT_FALSE(objects.buffer());
  EXPECT_EQ(uploaded_bytes(objects, *device), ENTRY_BYTES);
  EXPECT_EQ(uploaded_bytes(objects, *device), 0U);
  for (int i = 1; i < 1000; i++) {
    objects.add(glm::mat4(1));
  }
  EXPECT_EQ(uploaded_bytes(objects, *device), 1000 * ENTRY_BYTES);
  EXPECT_EQ(uploaded_bytes(objects, *device), 0U);
  const auto move = [&](ObjectIndex index) { objects.set(index, glm::mat4(float(objects.revision())), 0, {}); };
  move(500);
  EXPECT_EQ(uploaded_bytes(objects, *device), ENTRY_BYTES) << "one object";
  for (const ObjectIndex index : {10U, 11U, 12U, 900U}) {
    move(index);
  }
  EXPECT_EQ(uploaded_bytes(objects, *device), 4 * ENTRY_BYTES) << "a run, and one far from it";
  objects.set(500, objects.world_from_object(500), 0, {});
  EXPECT_EQ(uploaded_bytes(objects, *device), 0U) << "the same values";
  objects.remove(500);
  EXPECT_EQ(uploaded_bytes(objects, *device), 0U) << "a removed object is written by nobody";
  EXPECT_EQ(objects.add(glm::mat4(3)), 500U);
  EXPECT_EQ(uploaded_bytes(objects, *device), ENTRY_BYTES);
  move(0 + 1);
  move(999);
  EXPECT_EQ(uploaded_bytes(objects, *device), 2 * ENTRY_BYTES) << "the first and the last";
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
    EXPECT_GE(size, objects.size() * ENTRY_BYTES);
    EXPECT_GE(size, size_before);
    growths += size > size_before ? 1 : 0;
    size_before = size;
  }
  EXPECT_LE(growths, 12);
  for (ObjectIndex index = 1; index < objects.index_end(); index++) {
    objects.remove(index);
  }
  objects.upload(*device);
  EXPECT_EQ(objects.buffer().size_bytes(), size_before);
  EXPECT_EQ(device->live_resources().size(), 1U) << "a buffer that was outgrown lives";
}

TEST(ObjectBuffer, TakesAllThatTheLimitHoldsAndNamesItBeyond)
{
  // Slightly more than eight entries.
  gpu::Limits limits;
  limits.storage_block_bytes_max = 8 * ENTRY_BYTES + 100;
  const auto device = gpu::create_null_device(limits);
  ObjectBuffer objects;
  objects.upload(*device);
  while (objects.size() < 8) {
    objects.add(glm::mat4(1));
  }
  EXPECT_EQ(test::error_of([&] { objects.upload(*device); }), "");
  const ObjectIndex last = objects.add(glm::mat4(1));
  objects.set(1, glm::mat4(2), 0, {});
  test::expect_contains(test::error_of([&] { objects.upload(*device); }), "buffer 'object_block'");
  EXPECT_TRUE(objects.buffer()) << "what was there is lost";
  // The next attempt fails, too. Without the object above the limit it succeeds, and no edit is lost.
  EXPECT_NE(test::error_of([&] { objects.upload(*device); }), "");
  objects.remove(last);
  EXPECT_EQ(uploaded_bytes(objects, *device), ENTRY_BYTES) << "the object that was set";
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
