// SPDX-License-Identifier: MIT
#include "shadows/shadow_casters.hh"

#include "eevee_shadow_shared.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace gnomon::eevee {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

Caster caster_at(const glm::vec3 &center, float half, std::uint64_t fingerprint = 0)
{
  Caster caster;
  caster.bounds_ws.extend(center - half);
  caster.bounds_ws.extend(center + half);
  caster.fingerprint = fingerprint;
  return caster;
}

TEST(LampNear, IsBeforeEveryCasterAndAboveZero)
{
  const Caster box = caster_at(glm::vec3(0), 1.0F);
  // Along a cube face's axis a point at distance d is at least d / √3 away.
  EXPECT_LE(lamp_near({0, 5, 0}, infinity, {box}), 4.0F / std::sqrt(3.0F));
  EXPECT_GT(lamp_near({0, 5, 0}, infinity, {box}), 1.0F);
  EXPECT_GT(lamp_near({0, 0, 0}, infinity, {box}), 0.0F);
  EXPECT_GT(lamp_near({0, 0, 0}, infinity, {}), 0.0F);
  EXPECT_LE(lamp_near({0, 0, 0}, 7.0F, {}), 7.0F);
}

TEST(LampNear, OfALampInATerrainsBoxIsBeforeItsTriangles)
{
  // A slope 2 km wide: its box contains the lamp, and the slope is 3 m away.
  scene::Mesh slope;
  slope.positions = {{-1000, -100, -1000}, {1000, 100, -1000}, {1000, 100, 1000}, {-1000, -100, 1000}};
  slope.indices = {0, 1, 2, 0, 2, 3};
  for (const glm::vec3 &position : slope.positions) {
    slope.bounds.extend(position);
  }
  const glm::mat4 world_from_object(1.0F);
  Caster caster{.bounds_ws = slope.bounds, .mesh = &slope, .world_from_object = &world_from_object};
  const glm::vec3 above = 3.0F * glm::normalize(glm::vec3(-0.1F, 1, 0));
  EXPECT_NEAR(distance_to(caster, above), 3.0F, 1e-3F);
  EXPECT_LE(lamp_near(above, infinity, {caster}), 1.501F);
  EXPECT_GT(lamp_near(above, infinity, {caster}), 1.499F / std::exp2(0.0625F));
  EXPECT_NEAR(distance_to(caster, {900, 90, 0}), 0.0F, 1e-3F) << "on it";
  EXPECT_GT(lamp_near({900, 90, 0}, infinity, {caster}), 0.0F);
  // Beside its edge and its corner.
  EXPECT_NEAR(distance_to(caster, {-1000, -90, -1000}), 10.0F, 0.2F);
}

scene::Bounds box_around(const glm::vec3 &center, const glm::vec3 &half)
{
  return {center - half, center + half};
}

TEST(CubeFaceMask, HoldsEachFaceThatAPointOfTheBoxIsIn)
{
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  const auto point = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
  int skipped = 0;
  for (int i = 0; i < 3000; i++) {
    const glm::vec3 center = 10.0F * point();
    const glm::vec3 half = 3.0F * glm::abs(point());
    const std::uint32_t mask = cube_face_mask(box_around(center, half), 1.0F);
    skipped += mask == 63U ? 0 : 1;
    for (int j = 0; j < 20; j++) {
      const glm::vec3 p = center + half * point();
      ASSERT_TRUE(mask >> shared::cube_face(p) & 1U) << "center " << center.x << " " << center.y << " " << center.z;
    }
  }
  EXPECT_GT(skipped, 2500) << "a mask of all faces would be right, and useless";
}

TEST(CubeFaceMask, OfASmallBoxOnAnAxisIsOneFace)
{
  for (int axis = 0; axis < 3; axis++) {
    for (const float sign : {1.0F, -1.0F}) {
      glm::vec3 center(0.0F);
      center[axis] = 5.0F * sign;
      EXPECT_EQ(cube_face_mask(box_around(center, glm::vec3(1)), 1.0F), 1U << (2 * axis + (sign < 0.0F ? 1 : 0)));
    }
  }
  EXPECT_EQ(cube_face_mask(box_around(glm::vec3(0), glm::vec3(1)), 1.0F), 63U) << "around the lamp";
}

TEST(CubeFaceMask, OfAWideGroundLeavesOutTheFaceAbove)
{
  const std::uint32_t mask = cube_face_mask(box_around({0, -3, 0}, {100, 0, 100}), 1.0F);
  EXPECT_EQ(mask, 63U & ~(1U << 2));
}

TEST(ChangedBounds, CoverAddedAndRemovedCasters)
{
  const std::vector<Caster> before = {caster_at({0, 0, 0}, 1, 1), caster_at({5, 0, 0}, 1, 2),
                                      caster_at({9, 0, 0}, 1, 3)};
  EXPECT_TRUE(changed_bounds(before, before).empty());
  // In another order, and one moved.
  const std::vector<Caster> after = {caster_at({9, 0, 0}, 1, 3), caster_at({0, 0, 0}, 1, 1),
                                     caster_at({7, 0, 0}, 1, 4)};
  const std::vector<scene::Bounds> changed = changed_bounds(before, after);
  ASSERT_EQ(changed.size(), 2U);
  EXPECT_EQ(changed[0].center().x + changed[1].center().x, 12.0F);
  EXPECT_EQ(changed_bounds({}, after).size(), 3U);
}

TEST(ChangedBounds, AreThoseOfTheFingerprintsThatOneListHasMoreOftenThanTheOther)
{
  std::mt19937 random(5);
  const auto random_list = [&] {
    std::vector<Caster> casters;
    for (std::uint64_t count = random() % 9; count > 0; count--) {
      const std::uint64_t fingerprint = random() % 5;
      casters.push_back(caster_at({float(fingerprint), 0, 0}, 1, fingerprint));
    }
    return casters;
  };
  for (int i = 0; i < 500; i++) {
    const std::vector<Caster> before = random_list();
    const std::vector<Caster> after = random_list();
    std::array<int, 5> counts{};
    for (const Caster &caster : before) {
      counts[caster.fingerprint]++;
    }
    for (const Caster &caster : after) {
      counts[caster.fingerprint]--;
    }
    std::array<int, 5> changed{};
    for (const scene::Bounds &bounds : changed_bounds(before, after)) {
      changed[std::size_t(bounds.center().x)]++;
    }
    std::ranges::transform(counts, counts.begin(), [](int count) { return std::abs(count); });
    EXPECT_EQ(changed, counts) << i;
  }
}

}  // namespace
}  // namespace gnomon::eevee
