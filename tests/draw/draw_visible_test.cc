// SPDX-License-Identifier: MIT
#include "draw_visible.hh"

#include "gpu_error.hh"

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <set>

namespace gnomon::draw {
namespace {

constexpr float endless = std::numeric_limits<float>::infinity();

/** Perspective views with and without a far plane, and an orthographic one, near the origin and far from it. */
std::vector<View> some_views()
{
  std::vector<View> views;
  for (const float distance : {1.0F, 1e3F, 1e7F}) {
    const glm::vec3 eye = distance * glm::vec3(1.0F, -2.0F, 0.5F);
    const glm::mat4 view_from_world = glm::lookAt(eye, glm::vec3(0.3F), glm::vec3(0, 0, 1));
    for (const glm::mat4 &clip_from_view :
         {perspective(0.7F, 0.4F, 0.1F, 100.0F), perspective(0.7F, 0.4F, 0.1F, endless),
          orthographic(20.0F, 10.0F, 0.1F, 4.0F * distance)}) {
      views.emplace_back(view_from_world, clip_from_view);
    }
  }
  return views;
}

/** The count is no multiple of the number of objects that are tested at once. */
TEST(VisibleObjects, AreThoseWhoseVolumesTouchTheView)
{
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  ObjectBuffer objects;
  for (int i = 0; i < 1003; i++) {
    const float scale = std::exp2(float(random() % 30) - 5.0F);
    const glm::vec3 center = scale * glm::vec3(normal(random), normal(random), normal(random));
    objects.add(glm::mat4(1.0F), 0, {center, 0.3F * scale * std::abs(normal(random))});
  }
  objects.add(glm::mat4(1.0F), 0, {{1e9F, 0, 0}, -1.0F});
  objects.add(glm::mat4(1.0F), 0, {{1e9F, 0, 0}, endless});
  objects.add(glm::mat4(1.0F), 0, {{endless, 0, 0}, 1.0F});
  VisibleObjects visible;
  int count_of_all = 0;
  for (const View &view : some_views()) {
    visible.update(view, objects);
    int count = 0;
    for (ObjectIndex i = 0; i < objects.index_end(); i++) {
      EXPECT_EQ(visible.contains(i), view.touches(objects.volume(i))) << i;
      count += visible.contains(i) ? 1 : 0;
    }
    count_of_all += count;
    EXPECT_TRUE(visible.contains(objects.index_end() - 3)) << "it is never culled";
    EXPECT_TRUE(visible.contains(objects.index_end() - 2)) << "it is everywhere";
  }
  EXPECT_GT(count_of_all, 1000);
  EXPECT_LT(count_of_all, 8000);
}

TEST(VisibleObjects, FollowEditsAndViews)
{
  const View view(glm::mat4(1.0F), perspective(1.0F, 1.0F, 0.1F, 10.0F));
  const View backwards(glm::scale(glm::mat4(1.0F), glm::vec3(-1, 1, -1)), view.clip_from_view());
  ObjectBuffer objects;
  VisibleObjects visible;
  visible.update(view, objects);
  EXPECT_TRUE(visible.contains(object_identity));
  EXPECT_TRUE(visible.contains(1)) << "it did not exist";
  const ObjectIndex object = objects.add(glm::mat4(1.0F), 0, {{0, 0, -5}, 1.0F});
  visible.update(view, objects);
  EXPECT_TRUE(visible.contains(object));
  visible.update(backwards, objects);
  EXPECT_FALSE(visible.contains(object));
  objects.set(object, glm::mat4(1.0F), 0, {{0, 0, 5}, 1.0F});
  visible.update(backwards, objects);
  EXPECT_TRUE(visible.contains(object));
  ObjectBuffer others;
  others.add(glm::mat4(1.0F), 0, {{0, 0, -5}, 1.0F});
  objects.set(object, glm::mat4(1.0F), 0, {{0, 0, 5}, 2.0F});
  visible.update(backwards, others);
  EXPECT_FALSE(visible.contains(object));
}

TEST(VisibleObjects, AreWithoutThoseThatTheViewHides)
{
  const View view(glm::mat4(1.0F), perspective(1.0F, 1.0F, 0.1F, 10.0F));
  ObjectBuffer objects;
  const ObjectIndex first = objects.add(glm::mat4(1.0F), 0, {{0, 0, -5}, 1.0F});
  const ObjectIndex second = objects.add(glm::mat4(1.0F), 0, {{0, 0, -5}, -1.0F});
  std::vector<std::uint8_t> flags(100);
  flags[second] = 7;
  const View less = view.with_hidden(ObjectSet(flags));
  VisibleObjects visible;
  visible.update(view, objects);
  EXPECT_TRUE(visible.contains(second));
  visible.update(less, objects);
  EXPECT_TRUE(visible.contains(first));
  EXPECT_FALSE(visible.contains(second)) << "also if it is never culled";
  visible.update(view, objects);
  EXPECT_TRUE(visible.contains(second));
  // Sets are equal by their objects, so that a host may make one for each frame.
  flags.resize(second + 1);
  EXPECT_EQ(less, view.with_hidden(ObjectSet(flags)));
  EXPECT_NE(less, view);
  EXPECT_EQ(view, less.with_hidden(ObjectSet(std::vector<std::uint8_t>(5))));
  flags.resize(90);
  flags[80] = 1;
  // Objects that do not exist may be in a set.
  visible.update(view.with_hidden(ObjectSet(flags)), objects);
  EXPECT_FALSE(visible.contains(second));
}

TEST(ObjectBuffer, UsesTheLowestFreeIndexAfterAnyEdits)
{
  std::mt19937 random(11);
  ObjectBuffer objects;
  std::set<ObjectIndex> live = {object_identity};
  for (int i = 0; i < 5000; i++) {
    if (random() % 100 < (i / 500 % 2 == 0 ? 70U : 35U) || live.size() == 1) {
      ObjectIndex lowest = 0;
      for (const ObjectIndex index : live) {
        lowest += index == lowest ? 1 : 0;
      }
      ASSERT_EQ(objects.add(glm::mat4(1.0F)), lowest);
      live.insert(lowest);
    }
    else {
      const ObjectIndex removed = *std::next(live.begin(), 1 + std::ptrdiff_t(random() % (live.size() - 1)));
      objects.remove(removed);
      live.erase(removed);
    }
    ASSERT_EQ(objects.size(), live.size());
  }
  EXPECT_GT(live.size(), 100U);
}

TEST(ObjectBuffer, RefusesEachElementThatIsNotFinite)
{
  ObjectBuffer objects;
  for (const float bad : {endless, -endless, std::numeric_limits<float>::quiet_NaN()}) {
    for (int i = 0; i < 16; i++) {
      glm::mat4 matrix(std::numeric_limits<float>::max());
      matrix[i / 4][i % 4] = bad;
      EXPECT_THROW(objects.add(matrix), gpu::Error) << i;
    }
  }
  EXPECT_EQ(objects.size(), 1U);
  EXPECT_NO_THROW(objects.add(glm::mat4(std::numeric_limits<float>::max())));
}

}  // namespace
}  // namespace gnomon::draw
