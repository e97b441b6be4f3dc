// SPDX-License-Identifier: MIT
#include "shadows/shadow_view_volume.hh"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <limits>
#include <random>

namespace gnomon::eevee {
namespace {

double least_height(const draw::View &view, const glm::dvec3 &point)
{
  double least = std::numeric_limits<double>::infinity();
  for (const glm::vec4 &plane : view.frustum_planes_ws()) {
    least = std::min(least, glm::dot(glm::dvec3(plane), point) + double(plane.w));
  }
  return least;
}

TEST(VisibleCorners, HoldEveryPointThatIsInBoxAndFrustum)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  const auto point = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
  int touching = 0;
  for (int trial = 0; trial < 200; trial++) {
    scene::Bounds bounds;
    bounds.extend(3.0F * point());
    bounds.extend(3.0F * point());
    const bool is_infinite = trial % 3 == 0;
    const draw::View view(
        glm::lookAt(4.0F * point(), point(), glm::vec3(0, 1, 0.1F)),
        trial % 2 ? draw::perspective(0.4F, 0.3F, 0.1F, is_infinite ? std::numeric_limits<float>::infinity() : 6.0F)
                  : draw::orthographic(1.5F, 1.0F, 0.1F, 6.0F));
    const std::vector<glm::dvec3> corners = visible_corners(view, bounds);
    scene::Bounds hull;
    for (const glm::dvec3 &corner : corners) {
      EXPECT_GE(least_height(view, corner), -1e-4) << "a corner outside of the frustum";
      hull.extend(glm::vec3(corner));
    }
    int inside = 0;
    for (int i = 0; i < 2000; i++) {
      const glm::vec3 p = glm::mix(bounds.min, bounds.max, 0.5F + 0.5F * point());
      if (least_height(view, p) >= 1e-4) {
        inside++;
        ASSERT_FALSE(corners.empty()) << "trial " << trial;
        ASSERT_TRUE(glm::all(glm::greaterThanEqual(p, hull.min - 1e-4F)) &&
                    glm::all(glm::lessThanEqual(p, hull.max + 1e-4F)))
            << "trial " << trial;
      }
    }
    touching += inside > 0;
  }
  // The trials must contain both results.
  EXPECT_GT(touching, 60);
}

TEST(VisibleCorners, OfWhatIsBehindTheViewerAreNone)
{
  const draw::View view(glm::mat4(1.0F), draw::perspective(1.0F, 1.0F, 0.1F, 100.0F));
  scene::Bounds bounds;
  bounds.extend({-1, -1, 1});
  bounds.extend({1, 1, 2});
  EXPECT_TRUE(visible_corners(view, bounds).empty());
  EXPECT_TRUE(visible_corners(view, scene::Bounds()).empty());
}

TEST(VisibleCorners, OfAFlatBoxAreFound)
{
  const draw::View view(glm::mat4(1.0F), draw::perspective(1.0F, 1.0F, 0.1F, 100.0F));
  scene::Bounds bounds;
  bounds.extend({-50, -1, -50});
  bounds.extend({50, -1, 50});
  scene::Bounds hull;
  for (const glm::dvec3 &corner : visible_corners(view, bounds)) {
    hull.extend(glm::vec3(corner));
  }
  // At height -1 the lower edge of the picture meets the ground at z = -1.
  EXPECT_NEAR(hull.max.z, -1.0F, 1e-4F);
  EXPECT_NEAR(hull.min.z, -50.0F, 1e-4F);
  EXPECT_NEAR(hull.max.x, 50.0F, 1e-3F);
}

}  // namespace
}  // namespace gnomon::eevee
