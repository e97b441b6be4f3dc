// SPDX-License-Identifier: MIT
// Cascades that are fitted to the surfaces of a picture.
#include "shadows/shadow_casters.hh"
#include "shadows/shadow_sun_fit.hh"
#include "shadows/shadow_sun_slices.hh"
#include "shadows/shadow_view_volume.hh"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace gnomon::eevee {
namespace {

/** A ground at y = 0 with pillars of 1 m, seen through \a view. */
class SeenGround {
 public:
  explicit SeenGround(const draw::View &view)
      : view_(view), world_from_clip_(glm::inverse(glm::dmat4(view.clip_from_world())))
  {
  }

  /** The surface at \a ndc: the ground, or on every third metre of x the upper side of a pillar. Nothing above the
   * horizon. */
  [[nodiscard]] std::optional<glm::dvec3> surface(const glm::dvec2 &ndc) const
  {
    const glm::dvec3 near = at(ndc, 1.0);
    const glm::dvec3 direction = at(ndc, 0.5) - near;
    for (const double height : {1.0, 0.0}) {
      const double along = (height - near.y) / direction.y;
      const glm::dvec3 hit = near + along * direction;
      if (along > 0.0 && along * glm::length(direction) < 200.0 &&
          (height == 0.0 || (int(std::floor(hit.x)) % 3 == 0))) {
        return hit;
      }
    }
    return std::nullopt;
  }
  [[nodiscard]] float depth(const glm::dvec2 &ndc) const
  {
    const std::optional<glm::dvec3> hit = surface(ndc);
    const glm::dvec4 clip = glm::dmat4(view_.clip_from_world()) * glm::dvec4(hit.value_or(glm::dvec3(0)), 1.0);
    return hit ? float(clip.z / clip.w) : 0.0F;
  }

 private:
  [[nodiscard]] glm::dvec3 at(const glm::dvec2 &ndc, double depth) const
  {
    const glm::dvec4 p = world_from_clip_ * glm::dvec4(ndc, depth, 1.0);
    return glm::dvec3(p) / p.w;
  }

  draw::View view_;
  glm::dmat4 world_from_clip_;
};

/** The picture of a Ground. */
struct SeenGroundPicture {
  explicit SeenGroundPicture(const draw::View &seen, glm::ivec2 pixels = {83, 61})
      : view(seen), ground(seen), size_px(pixels)
  {
    for (int y = 0; y < size_px.y; y++) {
      for (int x = 0; x < size_px.x; x++) {
        depths.push_back(ground.depth(ndc(glm::dvec2(x, y) + 0.5)));
      }
    }
  }
  [[nodiscard]] glm::dvec2 ndc(const glm::dvec2 &pixel) const
  {
    return 2.0 * pixel / glm::dvec2(size_px) - 1.0;
  }
  [[nodiscard]] std::vector<VisibleCluster> clusters() const
  {
    return visible_clusters({depths, size_px, view});
  }

  draw::View view;
  SeenGround ground;
  glm::ivec2 size_px;
  std::vector<float> depths;
};

glm::mat4 looking_down_from(const glm::vec3 &from)
{
  return glm::lookAt(from, from + glm::vec3(0.3F, -0.4F, -1.0F), glm::vec3(0, 1, 0));
}

const std::array<draw::View, 3> ground_views = {
    draw::View(looking_down_from({1, 3, 4}),
               draw::perspective(0.6F, 0.4F, 0.1F, std::numeric_limits<float>::infinity())),
    draw::View(looking_down_from({1000, 30, -7000}), draw::perspective(0.2F, 0.1F, 0.5F, 300.0F)),
    draw::View(looking_down_from({1, 30, 4}), draw::orthographic(8.0F, 5.0F, 0.1F, 100.0F))};

/** Whether \a p is in the part of the frustum that the corners of \a cluster span. */
bool cluster_contains(const VisibleCluster &cluster, const draw::View &view, const glm::dvec3 &p)
{
  const auto place_of = [&](const glm::dvec3 &point) {
    const glm::dvec4 in_view = glm::dmat4(view.view_from_world()) * glm::dvec4(point, 1.0);
    const glm::dvec4 clip = glm::dmat4(view.clip_from_view()) * in_view;
    return glm::dvec3(clip.x / clip.w, clip.y / clip.w, -in_view.z);
  };
  glm::dvec3 min(std::numeric_limits<double>::infinity());
  glm::dvec3 max = -min;
  for (const glm::dvec3 &corner : cluster.corners_ws) {
    min = glm::min(min, place_of(corner));
    max = glm::max(max, place_of(corner));
  }
  const glm::dvec3 place = place_of(p);
  return glm::all(glm::greaterThanEqual(place, min)) && glm::all(glm::lessThanEqual(place, max));
}

TEST(VisibleClusters, ContainWhatOtherSamplesSeeOfTheSameSurface)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (const draw::View &view : ground_views) {
    const SeenGroundPicture picture(view);
    const std::vector<VisibleCluster> clusters = picture.clusters();
    int tested = 0;
    for (int i = 0; i < 3000; i++) {
      const glm::ivec2 pixel = glm::ivec2(glm::dvec2(unit(random), unit(random)) * glm::dvec2(picture.size_px));
      const std::optional<glm::dvec3> center = picture.ground.surface(picture.ndc(glm::dvec2(pixel) + 0.5));
      const std::optional<glm::dvec3> hit =
          picture.ground.surface(picture.ndc(glm::dvec2(pixel) + glm::dvec2(unit(random), unit(random))));
      // The same surface, and not so near to the horizon that it is more than 1 % farther.
      const auto distance = [&](const glm::dvec3 &p) {
        return -(glm::dmat4(view.view_from_world()) * glm::dvec4(p, 1)).z;
      };
      if (center && hit && center->y == hit->y && std::abs(distance(*hit) / distance(*center) - 1.0) < 0.01) {
        tested++;
        EXPECT_TRUE(
            std::ranges::any_of(clusters, [&](const VisibleCluster &c) { return cluster_contains(c, view, *hit); }))
            << hit->x << ", " << hit->y << ", " << hit->z;
      }
    }
    EXPECT_GT(tested, 1000);
    int pixels = 0;
    for (const VisibleCluster &cluster : clusters) {
      pixels += cluster.pixel_count;
      EXPECT_GE(cluster.range, 0);
      EXPECT_LT(cluster.range, distance_range_count);
    }
    EXPECT_EQ(pixels, std::ranges::count_if(picture.depths, [](float depth) { return depth > 0.0F; }));
  }
}

TEST(VisibleClusters, OfOneDistanceOrOfNothing)
{
  const std::vector<float> nothing(20, 0.0F);
  EXPECT_TRUE(visible_clusters({nothing, {5, 4}, ground_views[0]}).empty());
  EXPECT_TRUE(visible_clusters({}).empty());
  const std::vector<float> wall(20, 0.1F);
  const std::vector<VisibleCluster> clusters = visible_clusters({wall, {5, 4}, ground_views[0]});
  ASSERT_EQ(clusters.size(), 1U);
  EXPECT_EQ(clusters[0].pixel_count, 20);
  EXPECT_NEAR(clusters[0].distance, 1.0, 1e-5) << "near plane / depth";
}

/** Conditions for a sun from above, and a map of 1000 m behind the slices. */
SliceConditions slice_conditions()
{
  return {.lamp_from_world = glm::dmat3(1, 0, 0, 0, 0, 1, 0, -1, 0),
          .whole_min = glm::dvec2(-500.0),
          .whole_max = glm::dvec2(500.0),
          .whole_texel = glm::dvec2(1000.0 / 512.0),
          .slice_px = 500.0,
          .is_perspective = true,
          .pixel_size = 0.01};
}

glm::dvec2 in_slice(const SunSlice &slice, const SliceConditions &conditions, const glm::dvec3 &p)
{
  return glm::dvec2(turned(conditions.lamp_from_world, slice.turn) * p);
}

TEST(SunSlices, ContainRunsOfRangesWithLessErrorEachTime)
{
  const std::vector<VisibleCluster> clusters = SeenGroundPicture(ground_views[0]).clusters();
  const std::vector<SunSlices> choices = sun_slices(clusters, slice_conditions(), 3);
  ASSERT_EQ(choices.size(), 4U);
  EXPECT_TRUE(choices[0].slices.empty());
  for (std::size_t count = 1; count < 4; count++) {
    const SunSlices &choice = choices[count];
    ASSERT_EQ(choice.slices.size(), count);
    EXPECT_LT(choice.error, choices[count - 1].error);
    // The error of the documentation, recomputed from the slices: each cluster is in the first slice that contains it.
    double error = 0.0;
    double weight = 0.0;
    std::size_t slice = 0;
    for (int range = 0; range < distance_range_count; range++) {
      double pixels = 0.0;
      double pixel = 0.0;
      const auto holds_range = [&](const SunSlice &s) {
        return std::ranges::all_of(clusters, [&](const VisibleCluster &cluster) {
          return cluster.range != range || std::ranges::all_of(cluster.corners_ws, [&](const glm::dvec3 &corner) {
                   const glm::dvec2 p = in_slice(s, slice_conditions(), corner);
                   return glm::all(glm::greaterThanEqual(p, s.min - 1e-9)) &&
                          glm::all(glm::lessThanEqual(p, s.max + 1e-9));
                 });
        });
      };
      for (const VisibleCluster &cluster : clusters) {
        if (cluster.range == range) {
          pixels += cluster.pixel_count;
          pixel += cluster.pixel_count * 0.01 * cluster.distance;
        }
      }
      if (pixels == 0.0) {
        continue;
      }
      while (slice < count && !holds_range(choice.slices[slice])) {
        slice++;
      }
      const glm::dvec2 texel = slice < count ? (choice.slices[slice].max - choice.slices[slice].min) / 500.0
                                             : slice_conditions().whole_texel;
      const double q = std::sqrt(0.5 * glm::dot(texel, texel)) / (pixel / pixels);
      error += pixel * q * q;
      weight += pixel;
    }
    EXPECT_NEAR(error / weight, choice.error, 1e-9);
  }
}

TEST(SunSlices, TurnWithTheSurfaces)
{
  // A strip of 2 m by 40 m at 30° to the axes of the lamp: the best of the six turns is exactly along it.
  std::vector<VisibleCluster> strip(1);
  strip[0].distance = 10.0;
  strip[0].pixel_count = 100;
  for (std::size_t i = 0; i < 8; i++) {
    const glm::dvec2 p((i & 1U) != 0 ? 20.0 : -20.0, (i & 2U) != 0 ? 1.0 : -1.0);
    const double angle = std::numbers::pi / 6.0;
    const glm::dvec2 q(std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y);
    strip[0].corners_ws[i] = {q.x, 0.0, -q.y};
  }
  const SunSlices choice = sun_slices(strip, slice_conditions(), 1)[1];
  ASSERT_EQ(choice.slices.size(), 1U);
  glm::dvec2 size = choice.slices[0].max - choice.slices[0].min;
  EXPECT_NEAR(std::max(size.x, size.y), 40.0, 1e-6);
  EXPECT_NEAR(std::min(size.x, size.y), 2.0, 1e-6);
}

TEST(SunSlices, AreInsideOfTheMapBehindThemAndFiner)
{
  const std::vector<VisibleCluster> clusters = SeenGroundPicture(ground_views[0]).clusters();
  int slice_count = 0;
  for (const glm::dvec2 &center : {glm::dvec2(0.0), {-6.0, 3.0}, {6.0, 3.0}, {4.0, -5.0}}) {
    for (const double half : {3.0, 20.0, 200.0}) {
      for (const double texel : {0.001, 0.004, 0.008, 0.012, 0.02, 0.03, 0.05, 0.1, 0.3, 10.0}) {
        SliceConditions around = slice_conditions();
        around.whole_min = center - half;
        around.whole_max = center + half;
        around.whole_texel = glm::dvec2(texel);
        for (const SunSlices &choice : sun_slices(clusters, around, 3)) {
          if (center == glm::dvec2(0.0)) {
            EXPECT_TRUE(texel > 0.001 || choice.slices.empty()) << "nothing is finer";
          }
          for (const SunSlice &slice : choice.slices) {
            slice_count++;
            const glm::dvec2 size = slice.max - slice.min;
            EXPECT_LT(std::max(size.x, size.y) / around.slice_px, texel);
            // The corners of the map behind, in the axes of the slice.
            glm::dvec2 low(1e30);
            glm::dvec2 high(-1e30);
            for (const double x : {-half, half}) {
              for (const double y : {-half, half}) {
                const glm::dvec2 corner(turned(glm::dmat3(1.0), slice.turn) *
                                        glm::dvec3(center + glm::dvec2(x, y), 0.0));
                low = glm::min(low, corner);
                high = glm::max(high, corner);
              }
            }
            EXPECT_TRUE(glm::all(glm::greaterThanEqual(slice.min, low - 1e-9)));
            EXPECT_TRUE(glm::all(glm::lessThanEqual(slice.max, high + 1e-9)));
          }
        }
      }
    }
  }
  EXPECT_GT(slice_count, 20);
}

TEST(SunSlices, IgnoreSurfacesThatNothingCanDarken)
{
  const std::vector<VisibleCluster> clusters = SeenGroundPicture(ground_views[0]).clusters();
  SliceConditions elsewhere = slice_conditions();
  elsewhere.whole_min = glm::dvec2(5000.0);
  elsewhere.whole_max = glm::dvec2(6000.0);
  for (const SunSlices &choice : sun_slices(clusters, elsewhere, 3)) {
    EXPECT_TRUE(choice.slices.empty());
    EXPECT_EQ(choice.error, 0.0);
  }
}

/** A ground with boxes, and a camera above it. */
struct SunScene {
  SunScene()
  {
    add({0, 0, 0}, {150, 0, 150});
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
    for (int i = 0; i < 200; i++) {
      add({100.0F * unit(random), 1, 100.0F * unit(random)}, glm::vec3(1));
    }
    sun[2] = glm::vec4(glm::normalize(glm::vec3(0.4F, 1, 0.2F)), 0);
    sun[0] = glm::vec4(glm::normalize(glm::cross(glm::vec3(1, 0, 0), glm::vec3(sun[2]))), 0);
    sun[1] = glm::vec4(glm::cross(glm::vec3(sun[2]), glm::vec3(sun[0])), 0);
  }
  void add(const glm::vec3 &center, const glm::vec3 &half)
  {
    Caster caster;
    caster.bounds_ws.extend(center - half);
    caster.bounds_ws.extend(center + half);
    all.extend(center - half);
    all.extend(center + half);
    casters.push_back(caster);
  }
  [[nodiscard]] std::vector<SunFit> fits(const SeenGroundPicture &picture, bool is_fitted, int count, float pixel_size,
                                         bool can_resize = false, double texel_in_pixels_enlarged = texel_in_pixels,
                                         int edge_max_px = 0) const
  {
    const VisibleRange visible = visible_range(picture.view, visible_corners(picture.view, all));
    const std::vector<VisibleCluster> clusters = is_fitted ? picture.clusters() : std::vector<VisibleCluster>();
    const int asked_px = can_resize ? int(std::lround(size_px * size_growth_max)) : size_px;
    const CascadeSettings cascades{
        .count = count, .can_resize = can_resize, .texel_in_pixels_enlarged = texel_in_pixels_enlarged};
    return fit_sun(sun, picture.view, visible, casters, asked_px, cascades, pixel_size, {}, 0.0, clusters, edge_max_px);
  }

  static constexpr int size_px = 512;
  std::vector<Caster> casters;
  scene::Bounds all;
  glm::mat4 sun{1.0F};
};

/** Whether a filter kernel of 3 texels around \a p is inside of the map of \a fit. */
bool is_in_map(const SunFit &fit, const glm::dvec3 &p)
{
  const double inner = 1.0 - 2.0 * 3.0 / fit.size_px;
  const glm::dvec4 clip = glm::dmat4(fit.view.clip_from_world()) * glm::dvec4(p, 1.0);
  return std::max(std::abs(clip.x), std::abs(clip.y)) <= inner && clip.z >= 0.0 && clip.z <= 1.0;
}

/** The finest of \a fits with \a p and its filter inside; nullptr if there is none. */
const SunFit *map_of(const std::vector<SunFit> &fits, const glm::dvec3 &p)
{
  const auto found = std::ranges::find_if(fits, [&](const SunFit &fit) { return is_in_map(fit, p); });
  return found == fits.end() ? nullptr : &*found;
}

TEST(FittedCascades, HaveEveryVisibleReceiverInsideWithItsFilter)
{
  const SunScene scene;
  for (const draw::View &view :
       {ground_views[0], draw::View(looking_down_from({-40, 6, 70}), ground_views[0].clip_from_view())}) {
    const SeenGroundPicture picture(view);
    for (int count = 0; count <= cascade_count_max; count++) {
      const std::vector<SunFit> fits = scene.fits(picture, true, count, 0.01F);
      ASSERT_FALSE(fits.empty());
      EXPECT_TRUE(count == 0 || int(fits.size()) <= count);
      EXPECT_TRUE(std::ranges::is_sorted(fits, {}, [](const SunFit &fit) { return fit.texel(); }));
      for (const VisibleCluster &cluster : picture.clusters()) {
        for (const glm::dvec3 &corner : cluster.corners_ws) {
          // Beyond 100 m there is no caster, and receivers outside of the last map are lit.
          const bool is_receiver = std::abs(corner.x) < 100.0 && std::abs(corner.z) < 100.0 && corner.y >= 0.0 &&
                                   corner.y <= 2.0 && view.touches({glm::vec3(corner), 0.0F});
          EXPECT_TRUE(!is_receiver || map_of(fits, corner)) << corner.x << ", " << corner.y << ", " << corner.z;
        }
      }
    }
  }
}

TEST(FittedCascades, ShowTheirNeededBoxWithTheFilterAroundIt)
{
  const SunScene scene;
  const SeenGroundPicture picture(ground_views[0]);
  const std::vector<SunFit> fits = scene.fits(picture, true, cascade_count_max, 0.01F);
  ASSERT_EQ(fits.size(), std::size_t(cascade_count_max));
  int turned_count = 0;
  for (const SunFit &fit : fits) {
    turned_count += fit.turn != 0.0;
    const glm::dmat3 world_from_fit = glm::transpose(turned(glm::transpose(glm::dmat3(scene.sun)), fit.turn));
    for (int i = 0; i < 8; i++) {
      const glm::dvec2 corner((i & 1) != 0 ? fit.needed_max.x : fit.needed_min.x,
                              (i & 2) != 0 ? fit.needed_max.y : fit.needed_min.y);
      const double z = glm::dot(fit.slope, corner) + ((i & 4) != 0 ? fit.max.z : fit.min.z);
      // The depths are floats.
      const double inwards = (i & 4) != 0 ? -1e-4 : 1e-4;
      EXPECT_TRUE(is_in_map(fit, world_from_fit * glm::dvec3(corner, z + inwards))) << fit.turn;
    }
  }
  EXPECT_GT(turned_count, 0);
}

/** Texels of the coarsest map reach beyond the casters, into the receivers beside them. */
TEST(FittedCascades, HaveReceiversBesideNearCastersInAFinerMap)
{
  SunScene scene;
  scene.casters.resize(1);
  scene.add({3.2F, 1, -3.2F}, {0.05F, 1, 0.05F});
  scene.add({30, 1, -95}, {0.05F, 1, 0.05F});
  const SeenGroundPicture picture(ground_views[0], {160, 120});
  const std::vector<SunFit> fits = scene.fits(picture, true, cascade_count_max, 0.01F);
  ASSERT_GT(fits.size(), 1U);
  const auto is_covered = [](const SunFit &fit, const glm::dvec3 &p) {
    const glm::dvec4 clip = glm::dmat4(fit.view.clip_from_world()) * glm::dvec4(p, 1.0);
    return std::max(std::abs(clip.x), std::abs(clip.y)) <= 1.0;
  };
  int count = 0;
  for (const VisibleCluster &cluster : picture.clusters()) {
    for (const glm::dvec3 &corner : cluster.corners_ws) {
      if (cluster.distance < 12.0 && is_covered(fits.back(), corner)) {
        count++;
        EXPECT_TRUE(is_covered(fits.front(), corner)) << corner.x << ", " << corner.y << ", " << corner.z;
      }
    }
  }
  EXPECT_GT(count, 20);
}

/** Mean of q², see SunSlices::error, recomputed from the maps that pixels look up. \a pixel: edge at 1 m, metres. */
double mean_error(const std::vector<SunFit> &fits, const SeenGroundPicture &picture, double pixel)
{
  double sum = 0.0;
  double weight = 0.0;
  for (const VisibleCluster &cluster : picture.clusters()) {
    const glm::dvec3 middle = 0.5 * (cluster.corners_ws[0] + cluster.corners_ws[7]);
    if (const SunFit *fit = map_of(fits, middle)) {
      const double q = fit->texel() / (pixel * cluster.distance);
      sum += cluster.pixel_count * cluster.distance * q * q;
      weight += cluster.pixel_count * cluster.distance;
    }
  }
  return sum / weight;
}

double texel_count(const std::vector<SunFit> &fits)
{
  return double(fits.size()) * fits[0].size_px * fits[0].size_px;
}

TEST(FittedCascades, HaveFinerTexelsThanSlicesOfTheView)
{
  const SunScene scene;
  const SeenGroundPicture picture(ground_views[0]);
  for (int count = 2; count <= cascade_count_max; count++) {
    // The largest ratio is 0.54, of four maps.
    EXPECT_LT(mean_error(scene.fits(picture, true, count, 0.05F), picture, 0.05),
              0.6 * mean_error(scene.fits(picture, false, count, 0.05F), picture, 0.05))
        << count;
  }
}

TEST(FittedCascades, HaveTheSizeThatThePictureNeeds)
{
  const SunScene scene;
  const SeenGroundPicture picture(ground_views[0]);
  int smaller = 0;
  int larger = 0;
  for (const double pixel : {0.01, 0.1, 0.3, 1.0, 3.0}) {
    const std::vector<SunFit> fits = scene.fits(picture, true, 0, float(pixel), true);
    for (const SunFit &fit : fits) {
      EXPECT_EQ(fit.size_px, fits[0].size_px);
      EXPECT_LE(fit.size_px, std::lround(SunScene::size_px * size_growth_max));
    }
    if (fits[0].size_px < SunScene::size_px) {
      smaller++;
      // Below twice the square, because texel() is the longer edge of a texel.
      EXPECT_LT(mean_error(fits, picture, pixel), 2.0 * texel_in_pixels * texel_in_pixels) << pixel;
    }
    if (fits[0].size_px > std::ceil(SunScene::size_px * short_depth_gain)) {
      larger++;
      EXPECT_GT(mean_error(fits, picture, pixel), texel_in_pixels * texel_in_pixels);
    }
  }
  EXPECT_GE(smaller, 2);
  EXPECT_GE(larger, 1);
}

TEST(FittedCascades, AreEnlargedOnlyAboveTheLimitForTexels)
{
  const SunScene scene;
  const SeenGroundPicture picture(ground_views[0]);
  constexpr double limit = 2.0 * texel_in_pixels;
  int kept = 0;
  int enlarged = 0;
  for (float pixel = 0.01F; pixel < 3.0F; pixel *= 1.25F) {
    const double always = texel_count(scene.fits(picture, true, 0, pixel, true));
    const double never = texel_count(scene.fits(picture, true, 0, pixel, true, 1e9));
    const std::vector<SunFit> fits = scene.fits(picture, true, 0, pixel, true, limit);
    EXPECT_TRUE(texel_count(fits) == always || texel_count(fits) == never) << pixel;
    if (always > never && texel_count(fits) == never) {
      kept++;
      // Below twice the square, because texel() is the longer edge of a texel.
      EXPECT_LT(mean_error(fits, picture, pixel), 2.0 * limit * limit) << pixel;
    }
    if (always > never && texel_count(fits) == always) {
      enlarged++;
      EXPECT_GT(size_growth_max * size_growth_max * mean_error(fits, picture, pixel), limit * limit) << pixel;
    }
  }
  EXPECT_GE(kept, 1);
  EXPECT_GE(enlarged, 1);
}

TEST(FittedCascades, HaveTheFewestTexelsOfTheirError)
{
  const SunScene scene;
  // Seen from afar, all of the ground has pixels of about one size, so that one map is best.
  const SeenGroundPicture picture(
      draw::View(looking_down_from({1, 20, 4}), draw::perspective(0.1F, 0.08F, 0.1F, 1000.0F)));
  int fewer = 0;
  for (float pixel = 5e-4F; pixel < 0.5F; pixel *= 1.25F) {
    const std::vector<SunFit> shared = scene.fits(picture, true, 0, pixel, true);
    const std::vector<SunFit> alone = scene.fits(picture, true, 0, pixel, true, texel_in_pixels, 2 * SunScene::size_px);
    // Only a sun that has the array for itself has smaller texels, for its 16 bits. Edges are rounded up, 138.24 texels
    // to 139 here.
    const double gain = std::pow(short_depth_gain, 2.0);
    EXPECT_LE(double(texel_count(alone)), 1.02 * gain * double(texel_count(shared))) << pixel;
    if (texel_count(alone) < texel_count(shared)) {
      fewer++;
      // The error is that of both edges of texels, and texel() is the longer one.
      EXPECT_LT(mean_error(alone, picture, pixel), 1.5 * mean_error(shared, picture, pixel)) << pixel;
    }
    // No number of maps of the same size has fewer texels and less error.
    for (int count = 1; count <= cascade_count_max; count++) {
      const std::vector<SunFit> other = scene.fits(picture, true, count, pixel);
      EXPECT_FALSE(1.1 * texel_count(other) < texel_count(alone) &&
                   1.5 * mean_error(other, picture, pixel) < mean_error(alone, picture, pixel))
          << pixel << ", " << count;
    }
  }
  EXPECT_GE(fewer, 1);
}

TEST(FittedCascades, HaveDepthsFromAPlaneAlongTheReceivers)
{
  // A ground without an end, seen from near: along the light, it is as long as the ground.
  SunScene scene;
  scene.sun[2] = glm::vec4(glm::normalize(glm::vec3(1, 0.2F, 0.1F)), 0);
  scene.sun[0] = glm::vec4(glm::normalize(glm::cross(glm::vec3(0, 1, 0), glm::vec3(scene.sun[2]))), 0);
  scene.sun[1] = glm::vec4(glm::cross(glm::vec3(scene.sun[2]), glm::vec3(scene.sun[0])), 0);
  const SeenGroundPicture picture(ground_views[0]);
  for (const SunFit &fit : scene.fits(picture, true, cascade_count_max, 0.01F)) {
    const glm::dmat3 world_from_fit = glm::transpose(turned(glm::transpose(glm::dmat3(scene.sun)), fit.turn));
    const double length = fit.max.z - fit.min.z;
    EXPECT_LT(length, 0.6 * fit.caster_length);
    for (int i = 0; i < 25; i++) {
      const glm::dvec2 at = glm::mix(glm::dvec2(fit.min), glm::dvec2(fit.max), glm::dvec2(i % 5, i / 5) / 4.0);
      for (const double height : {0.0, 0.25, 1.0}) {
        const double z = glm::dot(fit.slope, at) + fit.min.z + height * length;
        const glm::dvec4 clip =
            glm::dmat4(fit.view.clip_from_world()) * glm::dvec4(world_from_fit * glm::dvec3(at, z), 1.0);
        // The matrix is one of floats.
        EXPECT_NEAR(clip.z, height, 1e-6 * fit.caster_length / length) << at.x << ", " << at.y;
        EXPECT_EQ(clip.w, 1.0);
      }
    }
  }
}

TEST(DepthRange, IsZeroOnAPlaneAndHoldsAllPoints)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int trial = 0; trial < 50; trial++) {
    const glm::dvec2 slope(10.0 * unit(random), 10.0 * unit(random));
    const double height = trial % 2 == 0 ? 0.0 : 0.1;
    std::vector<glm::dvec3> points;
    for (int i = 0; i < 40; i++) {
      const glm::dvec2 at(100.0 + 20.0 * unit(random), 20.0 * unit(random));
      points.emplace_back(at, 5.0 + glm::dot(slope, at) + height * unit(random));
    }
    const DepthRange range = depth_range(points);
    EXPECT_LE(range.max - range.min, 3.0 * height + 1e-9);
    for (const glm::dvec3 &point : points) {
      const double distance = point.z - glm::dot(range.slope, glm::dvec2(point));
      EXPECT_LE(range.min, distance);
      EXPECT_GE(range.max, distance);
    }
  }
  // Points on a line have no plane, and a single one has no range.
  EXPECT_EQ(depth_range(std::vector<glm::dvec3>{{1, 1, 2}, {2, 2, 5}}).slope, glm::dvec2(0.0));
  EXPECT_EQ(depth_range(std::vector<glm::dvec3>{{1, 2, 3}}).max, 3.0);
}

TEST(FittedCascades, AreAsManyAsThePictureNeeds)
{
  const SunScene scene;
  const SeenGroundPicture picture(ground_views[0]);
  EXPECT_EQ(scene.fits(picture, true, 0, 1000.0F).size(), 1U) << "coarse pixels";
  EXPECT_EQ(scene.fits(picture, true, 0, 1e-5F).size(), std::size_t(cascade_count_max)) << "fine pixels";
}

}  // namespace
}  // namespace gnomon::eevee
