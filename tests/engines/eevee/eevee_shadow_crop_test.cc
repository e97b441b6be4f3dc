// SPDX-License-Identifier: MIT
#include "eevee_shadow_shared.h"

#include "shadows/shadow_crop.hh"
#include "shadows/shadow_cube.hh"
#include "shadows/shadow_spot.hh"

#include <glm/common.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace gnomon::eevee {
namespace {

constexpr int crop_map_px = 256;

/** Position in the map of \a view, both axes -1 to 1; nothing for points behind the lamp. */
std::optional<glm::dvec2> ndc_of(const draw::View &view, const glm::dvec3 &point_ws)
{
  const glm::dvec4 clip =
      glm::dmat4(view.clip_from_view()) * glm::dmat4(view.view_from_world()) * glm::dvec4(point_ws, 1.0);
  return clip.w > 0.0 ? std::optional(glm::dvec2(clip) / clip.w) : std::nullopt;
}

/** Views with a fraction of their width that lookups reach. */
struct Map {
  draw::View view;
  double inner;
};

std::vector<Map> maps_at(const glm::vec3 &position_ws)
{
  std::vector<Map> maps;
  for (const draw::View &face : shadow_cube_views(position_ws, 0.01F, crop_map_px)) {
    maps.push_back({face, double(shared::cube_uv_scale(float(crop_map_px)))});
  }
  const glm::mat4 turned =
      glm::rotate(glm::translate(glm::mat4(1.0F), position_ws), 0.7F, glm::vec3(0.6F, -0.8F, 0.0F));
  const double border = 2.0 * CUBE_BORDER_TEXELS / crop_map_px;
  maps.push_back({shadow_spot_view(turned, 0.6F, 0.01F, crop_map_px), 1.0 - border});
  return maps;
}

TEST(ShadowCropTest, HoldsEveryLookupOfTheBoxesAndABorder)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  int checked = 0;
  int cropped = 0;
  for (int round = 0; round < 2000; round++) {
    const glm::vec3 position_ws(share(random), share(random), share(random));
    std::vector<VisibleBox> boxes;
    for (int i = 0; i < 1 + round % 3; i++) {
      const double size = std::pow(10.0, 2.0 * share(random) - 1.0);
      boxes.push_back({4.0 * glm::dvec3(share(random), share(random), share(random)),
                       size * glm::abs(glm::dvec3(share(random), share(random), share(random)))});
    }
    for (const Map &map : maps_at(position_ws)) {
      const std::optional<MapCrop> crop = map_crop(map.view, map.inner, crop_map_px, boxes);
      cropped += crop && *crop != whole_map ? 1 : 0;
      for (int i = 0; i < 8; i++) {
        const VisibleBox &box = boxes[std::size_t(i) % boxes.size()];
        const glm::dvec3 point_ws =
            box.center_ws + box.half_ws * glm::dvec3(share(random), share(random), share(random));
        const std::optional<glm::dvec2> whole_ndc = ndc_of(map.view, point_ws);
        if (!whole_ndc || std::max(std::abs(whole_ndc->x), std::abs(whole_ndc->y)) > map.inner) {
          continue;
        }
        ASSERT_TRUE(crop) << round;
        checked++;
        const glm::dvec2 ndc = *ndc_of(cropped_view(map.view, *crop), point_ws);
        // Where the crop ends at the edge of the map, the border is that of the map.
        const double border = 2.0 * CUBE_BORDER_TEXELS / crop_map_px;
        EXPECT_LE(std::max(std::abs(ndc.x), std::abs(ndc.y)), 1.0 - border + 1e-4) << round;
      }
    }
  }
  EXPECT_GT(checked, 2000);
  EXPECT_GT(cropped, 2000);
}

TEST(ShadowCropTest, IsNearlyAsSmallAsItsBox)
{
  // On the face +X of a lamp in the origin, from 0.1 to 0.2 to the right and up.
  const glm::dvec3 near(10.0, -2.0, -2.0);
  const glm::dvec3 far(10.0, -1.0, -1.0);
  const VisibleBox box{0.5 * (near + far), 0.5 * (far - near)};
  const draw::View face = shadow_cube_views(glm::vec3(0.0F), 0.01F, crop_map_px)[0];
  const auto crop = map_crop(face, double(shared::cube_uv_scale(float(crop_map_px))), crop_map_px, std::span(&box, 1));
  ASSERT_TRUE(crop);
  // A twentieth of the width, 7 texels of 256 as a border, and less than a step of 1 / 255 on each side.
  EXPECT_LE(extent_of(*crop).x, 0.05 / (1.0 - 7.0 / 256.0) + 2.0 / 255.0);
  EXPECT_LE(extent_of(*crop).y, 0.05 / (1.0 - 7.0 / 256.0) + 2.0 / 255.0);
}

TEST(ShadowCropTest, IsWholeAroundTheLampAndEmptyBehindIt)
{
  const draw::View spot = shadow_spot_view(glm::mat4(1.0F), 0.6F, 0.01F, crop_map_px);
  const VisibleBox around{glm::dvec3(0.0, 0.0, -0.5), glm::dvec3(1.0)};
  EXPECT_EQ(map_crop(spot, 0.97, crop_map_px, std::span(&around, 1)), std::optional(whole_map));
  const VisibleBox behind{glm::dvec3(0.0, 0.0, 2.0), glm::dvec3(1.0)};
  EXPECT_FALSE(map_crop(spot, 0.97, crop_map_px, std::span(&behind, 1)));
  const VisibleBox beside{glm::dvec3(9.0, 0.0, -2.0), glm::dvec3(1.0)};
  EXPECT_FALSE(map_crop(spot, 0.97, crop_map_px, std::span(&beside, 1)));
}

TEST(ShadowCropTest, OfTheWholeMapChangesNoView)
{
  const draw::View spot = shadow_spot_view(glm::mat4(1.0F), 0.6F, 0.01F, crop_map_px);
  EXPECT_EQ(cropped_view(spot, whole_map), spot);
}

TEST(ShadowCropTest, BoxesHoldTheirClusters)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  std::vector<VisibleCluster> clusters(40);
  for (std::size_t i = 0; i < clusters.size(); i++) {
    clusters[i].square = glm::ivec2(i % 10, i / 10);
    clusters[i].range = int(i % 3);
    for (glm::dvec3 &corner : clusters[i].corners_ws) {
      corner = glm::dvec3(double(i), 0.0, 0.0) + glm::dvec3(share(random), share(random), share(random));
    }
  }
  const std::vector<VisibleBox> boxes = visible_boxes(clusters);
  EXPECT_LT(boxes.size(), clusters.size());
  for (const VisibleCluster &cluster : clusters) {
    EXPECT_TRUE(std::ranges::any_of(boxes, [&](const VisibleBox &box) {
      return std::ranges::all_of(cluster.corners_ws, [&](const glm::dvec3 &corner) {
        return glm::all(glm::lessThanEqual(glm::abs(corner - box.center_ws), box.half_ws));
      });
    }));
  }
}

}  // namespace
}  // namespace gnomon::eevee
