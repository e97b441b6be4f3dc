// SPDX-License-Identifier: MIT
#include "shadows/shadow_sun_fit.hh"

#include "shadows/shadow_casters.hh"
#include "shadows/shadow_view_volume.hh"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace gnomon::eevee {
namespace {

scene::PlacedLamp sun_along(const glm::vec3 &forward)
{
  scene::PlacedLamp lamp;
  lamp.kind = scene::LampKind::Sun;
  const glm::vec3 z = -glm::normalize(forward);
  const glm::vec3 x = glm::normalize(glm::cross(std::abs(z.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0), z));
  lamp.world_from_lamp =
      glm::mat4(glm::vec4(x, 0), glm::vec4(glm::cross(z, x), 0), glm::vec4(z, 0), glm::vec4(0, 0, 0, 1));
  return lamp;
}

Caster caster_at(const glm::vec3 &center, const glm::vec3 &half)
{
  Caster caster;
  caster.bounds_ws.extend(center - half);
  caster.bounds_ws.extend(center + half);
  return caster;
}

scene::Bounds bounds_of(const std::vector<Caster> &casters)
{
  scene::Bounds all;
  for (const Caster &caster : casters) {
    all.extend(caster.bounds_ws);
  }
  return all;
}

VisibleRange range_of(const draw::View &view, const std::vector<Caster> &casters)
{
  return visible_range(view, visible_corners(view, bounds_of(casters)));
}

/** An arbitrary view, for fits to given receivers. */
const draw::View any_view(glm::mat4(1.0F), draw::perspective(1.0F, 1.0F, 0.1F, 100.0F));

std::vector<SunFit> fit_one(const scene::PlacedLamp &lamp, const std::vector<glm::dvec3> &receivers,
                            const std::vector<Caster> &casters, int size_px)
{
  return fit_sun(glm::mat4(lamp.world_from_lamp), any_view, visible_range(any_view, receivers), casters, size_px,
                 {.count = 1}, 0.001F);
}

TEST(SunFit, HoldsEveryCasterOfAVisibleReceiver)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  const auto point = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
  for (int trial = 0; trial < 100; trial++) {
    const scene::PlacedLamp lamp = sun_along(point() + glm::vec3(0, -1.5F, 0));
    std::vector<Caster> casters;
    for (int i = 0; i < 12; i++) {
      casters.push_back(caster_at(6.0F * point(), glm::vec3(0.5F)));
    }
    const scene::Bounds all = bounds_of(casters);
    const draw::View view(glm::lookAt(10.0F * point(), point(), glm::vec3(0, 1, 0)),
                          draw::perspective(0.3F, 0.2F, 0.1F, 50.0F));
    const std::vector<SunFit> fits = fit_sun(glm::mat4(lamp.world_from_lamp), view, range_of(view, casters), casters,
                                             512, {.count = 1 + trial % 4}, 0.001F);
    // A ray from a visible receiver towards the sun that meets a caster: caster point and receiver both in the last
    // map.
    for (int i = 0; i < 4000; i++) {
      const glm::vec3 caster = casters[std::size_t(i) % 12].bounds_ws.center() + 0.49F * point();
      const glm::vec3 receiver = caster - glm::vec3(lamp.world_from_lamp[2]) * (6.0F * std::abs(unit(random)));
      const bool is_seen = glm::all(glm::greaterThanEqual(receiver, all.min)) &&
                           glm::all(glm::lessThanEqual(receiver, all.max)) && view.touches({receiver, 0.0F});
      if (is_seen) {
        ASSERT_FALSE(fits.empty()) << "trial " << trial;
        for (const glm::vec3 &p : {caster, receiver}) {
          const glm::vec4 clip = fits.back().view.clip_from_world() * glm::vec4(p, 1.0F);
          ASSERT_LE(std::max(std::abs(clip.x), std::abs(clip.y)), 1.0F) << "trial " << trial;
          ASSERT_GE(clip.z, 0.0F);
          ASSERT_LE(clip.z, 1.0F);
        }
      }
    }
  }
}

TEST(SunFit, HoldsEveryCasterWhosePenumbraIsVisible)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  const auto point = [&] { return glm::vec3(unit(random), unit(random), unit(random)); };
  int held = 0;
  for (int trial = 0; trial < 100; trial++) {
    const scene::PlacedLamp lamp = sun_along(point() + glm::vec3(0, -1.5F, 0));
    const glm::vec3 to_light(lamp.world_from_lamp[2]);
    const float tangent = 0.6F * std::abs(unit(random));
    const Caster caster = caster_at(4.0F * point(), glm::vec3(1.0F));
    std::vector<glm::dvec3> receivers;
    for (int i = 0; i < 4; i++) {
      receivers.emplace_back(4.0F * point() + glm::vec3(0, -6, 0));
    }
    const std::vector<SunFit> fits =
        fit_sun(glm::mat4(lamp.world_from_lamp), any_view, visible_range(any_view, receivers), {caster}, 512,
                {.count = 1}, 0.001F, {}, double(tangent));
    // A point of the caster in the cone of the sun above a receiver is in the map.
    for (int i = 0; i < 200; i++) {
      const glm::vec3 p = caster.bounds_ws.center() + point();
      for (const glm::dvec3 &receiver : receivers) {
        const glm::vec3 v = p - glm::vec3(receiver);
        const float along = glm::dot(v, to_light);
        if (along > 0.0F && glm::length(v - along * to_light) < tangent * along) {
          ASSERT_FALSE(fits.empty()) << "trial " << trial;
          const glm::vec4 clip = fits.back().view.clip_from_world() * glm::vec4(p, 1.0F);
          ASSERT_LE(std::max(std::abs(clip.x), std::abs(clip.y)), 1.0F) << "trial " << trial;
          ASSERT_GE(clip.z, 0.0F);
          ASSERT_LE(clip.z, 1.0F);
          held++;
        }
      }
    }
  }
  EXPECT_GT(held, 1000);
}

TEST(SunFit, LeavesTheGroundOutOfTheCasters)
{
  const Caster ground = caster_at({0, 0, 0}, {100, 0, 100});
  const std::vector<glm::dvec3> receivers = {{-100, 0, -100}, {100, 0, -100}, {-100, 0, 100}, {100, 3, 100}};
  const std::vector<Caster> casters = {ground, caster_at({0, 1, 0}, glm::vec3(1))};
  const scene::PlacedLamp sun = sun_along({0.3F, -1, 0});
  const std::vector<SunFit> fits = fit_one(sun, receivers, casters, 1024);
  ASSERT_EQ(fits.size(), 1U);
  EXPECT_LT(fits[0].max.x - fits[0].min.x, 6.0);
  EXPECT_LT(fits[0].max.y - fits[0].min.y, 6.0);
  EXPECT_TRUE(fit_one(sun, receivers, {ground}, 1024).empty()) << "the ground alone darkens nothing";
}

TEST(SunFit, KeepsGroundAboveVisibleReceivers)
{
  // A ceiling is flat, too, and shadows the receivers below.
  EXPECT_FALSE(
      fit_one(sun_along({0, -1, 0}), {{-1, 0, -1}, {1, 0, 1}}, {caster_at({0, 4, 0}, {2, 0, 2})}, 256).empty());
}

// hazards.md: a degenerate frustum returned an uninitialised matrix.
TEST(SunFit, OfASinglePointIsFinite)
{
  for (const SunFit &fit : fit_one(sun_along({0, -1, 0}), {{1, 2, 3}}, {caster_at({1, 2, 3}, glm::vec3(0))}, 64)) {
    for (int i = 0; i < 16; i++) {
      EXPECT_TRUE(std::isfinite(fit.view.clip_from_world()[i / 4][i % 4]));
    }
  }
  EXPECT_TRUE(fit_one(sun_along({0, -1, 0}), {}, {caster_at({1, 2, 3}, glm::vec3(1))}, 64).empty());
}

// hazards.md: scale-free from 1e-4 to 1e5 m.
TEST(SunFit, IsTheSameAtEveryScale)
{
  for (const float scale : {1e-4F, 1.0F, 1e5F}) {
    const std::vector<SunFit> fits = fit_one(
        sun_along({0.2F, -1, 0.1F}), {glm::dvec3(-2, 0, -2) * double(scale), glm::dvec3(2, 1, 2) * double(scale)},
        {caster_at(glm::vec3(0, 0.5F * scale, 0), glm::vec3(0.5F * scale))}, 512);
    ASSERT_EQ(fits.size(), 1U);
    EXPECT_NEAR((fits[0].max.x - fits[0].min.x) / double(scale), 1.1, 0.5);
    const glm::vec4 clip = fits[0].view.clip_from_world() * glm::vec4(0, scale, 0, 1);
    EXPECT_LE(std::abs(clip.x), 1.0F);
    EXPECT_GT(clip.z, 0.5F);
  }
}

TEST(CascadeSplits, CoverTheRangeWithoutAGap)
{
  for (const double near : {0.1, 5.0, -3.0}) {
    for (const double lambda : {0.0, 0.5, 1.0}) {
      for (int count = 1; count <= cascade_count_max; count++) {
        const std::vector<double> splits = cascade_splits(near, 300.0, count, lambda);
        ASSERT_EQ(splits.size(), std::size_t(count) + 1);
        EXPECT_EQ(splits.front(), near);
        EXPECT_EQ(splits.back(), 300.0);
        EXPECT_TRUE(std::ranges::is_sorted(splits));
      }
    }
  }
  // Zhang et al.: λ 1 has one ratio from each to the next, λ 0 one difference.
  const std::vector<double> logarithmic = cascade_splits(1.0, 81.0, 4, 1.0);
  EXPECT_NEAR(logarithmic[1], 3.0, 1e-9);
  EXPECT_NEAR(logarithmic[3], 27.0, 1e-9);
  EXPECT_NEAR(cascade_splits(1.0, 81.0, 4, 0.0)[1], 21.0, 1e-9);
}

TEST(SliceSphere, HoldsTheSliceAndIsTight)
{
  const glm::mat4 view_from_world = glm::lookAt(glm::vec3(3, 4, 5), glm::vec3(0, 1, 0), glm::vec3(0, 1, 0));
  for (const glm::mat4 &projection :
       {draw::perspective(0.8F, 0.5F, 0.1F, 100.0F), draw::perspective(0.05F, 0.05F, 0.1F, 100.0F),
        draw::orthographic(4.0F, 3.0F, 0.1F, 100.0F)}) {
    const draw::View view(view_from_world, projection);
    const Sphere sphere = slice_sphere(view, 2.0, 6.0);
    double farthest = 0.0;
    for (int i = 0; i < 8; i++) {
      const double distance = (i & 4) != 0 ? 6.0 : 2.0;
      const double w = view.is_perspective() ? distance : 1.0;
      const glm::dvec4 corner((i & 1 ? 1 : -1) * w / double(projection[0][0]),
                              (i & 2 ? 1 : -1) * w / double(projection[1][1]), -distance, 1.0);
      const glm::dvec3 world(glm::inverse(glm::dmat4(view_from_world)) * corner);
      farthest = std::max(farthest, glm::distance(world, sphere.center_ws));
    }
    EXPECT_NEAR(farthest, sphere.radius, 1e-5);
  }
}

/** Boxes over 200 m, and a camera among them. */
struct Field {
  Field()
  {
    casters.push_back(caster_at({0, 0, 0}, {150, 0, 150}));
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
    for (int i = 0; i < 300; i++) {
      casters.push_back(caster_at({100.0F * unit(random), 1, 100.0F * unit(random)}, glm::vec3(1)));
    }
  }
  [[nodiscard]] draw::View view_at(const glm::vec3 &position) const
  {
    return {glm::lookAt(position, position + glm::vec3(0, -0.1F, -1), glm::vec3(0, 1, 0)),
            draw::perspective(0.6F, 0.4F, 0.1F, 1000.0F)};
  }
  [[nodiscard]] std::vector<SunFit> fit_at(const draw::View &view, int count, float pixel_size = 0.001F) const
  {
    return fit_sun(glm::mat4(sun.world_from_lamp), view, range_of(view, casters), casters, 1024, {.count = count},
                   pixel_size);
  }
  std::vector<Caster> casters;
  scene::PlacedLamp sun = sun_along({0.4F, -1, 0.2F});
};

TEST(Cascades, CoverWhatIsVisibleAndAreFinerNearby)
{
  const Field field;
  const draw::View view = field.view_at({0, 2, 90});
  const std::vector<SunFit> fits = field.fit_at(view, 4);
  ASSERT_EQ(fits.size(), 4U);
  for (std::size_t i = 1; i < fits.size(); i++) {
    EXPECT_LT(fits[i - 1].texel(), fits[i].texel());
  }
  // Each point of a slice is in its own map.
  const VisibleRange range = range_of(view, field.casters);
  const std::vector<double> splits = cascade_splits(range.near, range.far, 4, CascadeSettings().lambda);
  const glm::dmat4 world_from_view = glm::inverse(glm::dmat4(view.view_from_world()));
  for (std::size_t slice = 0; slice < 4; slice++) {
    for (int i = 0; i < 64; i++) {
      const double distance = splits[slice] + (splits[slice + 1] - splits[slice]) * (i / 63.0);
      const glm::dvec4 in_view((i % 4 - 1.5) / 1.5 * 0.6 * distance, (i / 4 % 4 - 1.5) / 1.5 * 0.4 * distance,
                               -distance, 1);
      const glm::dvec3 world(world_from_view * in_view);
      const bool is_in_bounds =
          std::abs(world.x) < 100.0 && std::abs(world.z) < 100.0 && world.y >= 0.0 && world.y <= 2.0;
      if (is_in_bounds) {
        const glm::vec4 clip = fits[slice].view.clip_from_world() * glm::vec4(world, 1.0F);
        EXPECT_LE(std::max(std::abs(clip.x), std::abs(clip.y)), 1.0F) << "slice " << slice;
      }
    }
  }
}

TEST(Cascades, CountGivesTexelsNoLargerThanPixels)
{
  const Field field;
  const draw::View view = field.view_at({0, 2, 90});
  EXPECT_EQ(field.fit_at(view, 0, 100.0F).size(), 1U) << "coarse pixels";
  EXPECT_EQ(field.fit_at(view, 0, 1e-5F).size(), std::size_t(cascade_count_max)) << "pixels finer than any map";
}

TEST(Cascades, KeepTheirTexelsWhenTheCameraMoves)
{
  const Field field;
  const std::vector<SunFit> first = field.fit_at(field.view_at({0, 2, 90}), 3);
  int kept = 0;
  for (int step = 1; step <= 40; step++) {
    const std::vector<SunFit> moved =
        field.fit_at(field.view_at({0.013F * float(step), 2, 90 - 0.031F * float(step)}), 3);
    ASSERT_EQ(moved.size(), first.size());
    for (std::size_t i = 0; i < moved.size(); i++) {
      kept += still_fits(first[i], moved[i]) ? 1 : 0;
      for (int axis = 0; axis < 2; axis++) {
        // They have the same size, and their offset is a whole number of texels.
        const double texel = (first[i].max[axis] - first[i].min[axis]) / 1024;
        const double moved_texel = (moved[i].max[axis] - moved[i].min[axis]) / 1024;
        if (std::abs(moved_texel / texel - 1.0) < 1e-12) {
          const double apart = (moved[i].min[axis] - first[i].min[axis]) / texel;
          EXPECT_NEAR(apart, std::round(apart), 1e-6);
        }
        else {
          EXPECT_NEAR(std::log2(moved_texel / texel) * 8.0, std::round(std::log2(moved_texel / texel) * 8.0), 1e-9);
        }
      }
    }
  }
  EXPECT_GT(kept, 60) << "of 120: most need not be drawn again";
}

}  // namespace
}  // namespace gnomon::eevee
