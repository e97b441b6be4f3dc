// SPDX-License-Identifier: MIT
// Lists of the lights that reach parts of a view, without a driver: no light is missing, and the lists stay short.
#include "eevee_light_clusters.hh"

#include "eevee_test_scene.hh"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <numbers>
#include <random>
#include <set>

namespace gnomon::eevee {
namespace {

/** Deterministic random numbers. */
class RandomValues {
 public:
  explicit RandomValues(std::uint32_t seed) : engine_(seed) {}
  float in(float low, float high)
  {
    return std::uniform_real_distribution<float>(low, high)(engine_);
  }
  glm::vec3 in_box(float half)
  {
    return {in(-half, half), in(-half, half), in(-half, half)};
  }
  glm::vec3 direction()
  {
    const float z = in(-1.0F, 1.0F);
    const float angle = in(0.0F, 2.0F * std::numbers::pi_v<float>);
    return {std::sqrt(1.0F - z * z) * std::cos(angle), std::sqrt(1.0F - z * z) * std::sin(angle), z};
  }

 private:
  std::mt19937 engine_;
};

/** Points and spots with ranges from 1 % to all of \a extent, and some that reach everywhere, around \a center. */
std::vector<scene::PlacedLamp> random_lamps(RandomValues &random, int count, const glm::vec3 &center, float extent)
{
  std::vector<scene::PlacedLamp> lamps;
  for (int i = 0; i < count; i++) {
    scene::PlacedLamp &lamp = lamps.emplace_back();
    lamp.kind = i % 3 == 0 ? scene::LampKind::Spot : scene::LampKind::Point;
    lamp.range = i % 11 == 0 ? 0.0F : extent * std::pow(10.0F, random.in(-2.0F, 0.0F));
    lamp.spot_outer_angle = random.in(0.01F, 1.5F);
    const glm::vec3 position = center + random.in_box(extent);
    const glm::vec3 forward = random.direction();
    const glm::vec3 up = std::abs(forward.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    lamp.world_from_lamp =
        glm::inverse(glm::lookAt(glm::dvec3(position), glm::dvec3(position + forward), glm::dvec3(up)));
  }
  return lamps;
}

/** Whether a shader finds light of \a light at a point. */
bool gives_light(const shared::LightData &light, const glm::vec3 &position_ws)
{
  const glm::vec3 to_light = light.position_ws - position_ws;
  const float distance_sq = glm::dot(to_light, to_light);
  float irradiance = shared::distance_falloff(distance_sq, light.radius_sq, light.range_inv_sq);
  if (light.kind == LIGHT_SPOT && distance_sq > 0.0F) {
    const float drop = shared::one_minus_cos(-to_light / std::sqrt(distance_sq), light.forward_ws);
    irradiance *= shared::spot_mask(drop, light.spot_drop_outer, light.spot_inv_width);
  }
  return irradiance > 0.0F;
}

/** The entries of the froxel that contains a point. */
std::span<const float> list_at(const LightClusters &clusters, const glm::vec3 &position_ws)
{
  const auto froxel = std::size_t(shared::light_froxel(clusters.block(), position_ws));
  const std::span<const float> values = clusters.values();
  const auto first = std::size_t(values[2 * froxel]);
  return values.subspan(first, std::size_t(values[2 * froxel + 2]) - first);
}

struct NamedView {
  const char *name;
  draw::View view;
  /** Depths of the test's points, metres. */
  float near;
  float far;
};

std::vector<NamedView> views_at(const glm::vec3 &eye, const glm::vec3 &forward, float extent)
{
  const glm::vec3 up = std::abs(forward.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
  const glm::mat4 view_from_world = glm::lookAt(eye, eye + forward, up);
  const float near = 1e-3F * extent;
  const float far = 4.0F * extent;
  constexpr float infinity = std::numeric_limits<float>::infinity();
  glm::mat4 shifted = draw::perspective(0.5F, 0.4F, near, infinity);
  // The middle of the view is at the edge of the picture.
  shifted[2][0] = 0.9F;
  shifted[2][1] = -0.7F;
  return {
      {"wide", {view_from_world, draw::perspective(3.0F, 2.0F, near, far)}, near, far},
      {"usual", {view_from_world, draw::perspective(0.7F, 0.4F, near, infinity)}, near, far},
      {"narrow", {view_from_world, draw::perspective(0.01F, 0.01F, near, far)}, near, far},
      {"shifted", {view_from_world, shifted}, near, far},
      {"orthographic", {view_from_world, draw::orthographic(extent, 0.6F * extent, -extent, far)}, -extent, far},
      {"small orthographic", {view_from_world, draw::orthographic(0.1F * extent, 0.1F * extent, 0.0F, far)}, 0, far}};
}

/** A point of the view, and of up to half a pixel beyond its edges, as samples are offset. */
glm::vec3 random_point(RandomValues &random, const NamedView &named, glm::ivec2 view_size_px)
{
  const glm::dmat4 clip_from_view(named.view.clip_from_view());
  const float share = random.in(0.0F, 1.0F);
  const double depth = named.view.is_perspective()
                           ? named.near * std::pow(double(named.far) / named.near, double(share))
                           : glm::mix(named.near, named.far, share);
  const glm::dvec2 widened = 1.0 + 1.0 / glm::dvec2(view_size_px);
  const glm::dvec2 ndc = widened * glm::dvec2(random.in(-1, 1), random.in(-1, 1));
  const double w = named.view.is_perspective() ? depth : 1.0;
  const glm::dvec4 view((w * ndc.x - clip_from_view[3][0] + depth * clip_from_view[2][0]) / clip_from_view[0][0],
                        (w * ndc.y - clip_from_view[3][1] + depth * clip_from_view[2][1]) / clip_from_view[1][1],
                        -depth, 1.0);
  return glm::vec3(glm::inverse(glm::dmat4(named.view.view_from_world())) * view);
}

void expect_complete(const Lamps &lamps, const LightClusters &clusters, const glm::vec3 &position_ws, const char *name)
{
  const std::span<const float> list = list_at(clusters, position_ws);
  for (std::size_t light = 0; light < lamps.lights.size(); light++) {
    if (!lamps.reaches[light].is_everywhere() && gives_light(lamps.lights[light], position_ws)) {
      EXPECT_TRUE(std::ranges::binary_search(list, float(light)))
          << name << ": light " << light << " at " << position_ws.x << " " << position_ws.y << " " << position_ws.z;
    }
  }
}

TEST(LightClusters, ListEachLampThatReachesAPointOfTheView)
{
  constexpr glm::ivec2 view_size_px(160, 100);
  RandomValues random(1);
  LightClusters clusters;
  std::size_t lit_count = 0;
  // Also far from the origin of the coordinates, and small and large scenes.
  for (const auto &[center, extent] : {std::pair(glm::vec3(0), 10.0F),
                                       {glm::vec3(900, -700, 400), 10.0F},
                                       {glm::vec3(5e4F, 2e4F, -3e4F), 100.0F},
                                       {glm::vec3(0), 0.01F},
                                       {glm::vec3(3, 0, 0), 1e5F}}) {
    const std::vector<scene::PlacedLamp> placed = random_lamps(random, 60, center, extent);
    const Lamps lamps = make_lamps(placed);
    for (int i = 0; i < 3; i++) {
      const glm::vec3 eye = center + random.in_box(0.7F * extent);
      for (const NamedView &named : views_at(eye, random.direction(), extent)) {
        clusters.build(lamps, named.view, view_size_px, scene::Bounds());
        for (int j = 0; j < 300; j++) {
          const glm::vec3 point = random_point(random, named, view_size_px);
          expect_complete(lamps, clusters, point, named.name);
          lit_count += list_at(clusters, point).empty() ? 0 : 1;
        }
        // Points close to where the reach of a lamp ends.
        for (const shared::LightData &light : lamps.lights) {
          const float range = light.range_inv_sq > 0.0F ? 1.0F / std::sqrt(light.range_inv_sq) : 0.0F;
          const glm::vec3 point = light.position_ws + 0.9999F * range * random.direction();
          const glm::vec4 clip = named.view.clip_from_world() * glm::vec4(point, 1.0F);
          if (clip.w > 0.0F && std::max(std::abs(clip.x), std::abs(clip.y)) <= clip.w && clip.z >= 0.0F &&
              clip.z <= clip.w) {
            expect_complete(lamps, clusters, point, named.name);
          }
        }
      }
    }
  }
  EXPECT_GT(lit_count, 5000U) << "most lists are empty";
}

TEST(LightClusters, ListLampsFromAllOfTheirPoints)
{
  constexpr glm::ivec2 view_size_px(160, 100);
  RandomValues random(2);
  std::vector<scene::PlacedLamp> placed = random_lamps(random, 30, glm::vec3(0), 10.0F);
  for (std::size_t i = 0; i < placed.size(); i++) {
    placed[i].radius = i % 2 == 0 ? 1.0F : 0.0F;
  }
  const Lamps lamps = make_lamps(placed, LampShading::Point);
  LightClusters clusters;
  for (const NamedView &named : views_at({0, 0, 8}, {0, 0, -1}, 10.0F)) {
    clusters.build(lamps, named.view, view_size_px, scene::Bounds());
    for (int j = 0; j < 300; j++) {
      Lamps moved = lamps;
      for (std::size_t i = 0; i < moved.lights.size(); i++) {
        moved.lights[i].position_ws += placed[lamps.lamp_index[i]].radius * random.direction();
      }
      expect_complete(moved, clusters, random_point(random, named, view_size_px), named.name);
    }
  }
}

// Samples are offset by half a pixel. The range of each lamp is less than that.
TEST(LightClusters, ListLampsAtTheEdgesOfTheView)
{
  constexpr glm::ivec2 view_size_px(160, 100);
  const draw::View view(glm::mat4(1.0F), draw::orthographic(16.0F, 10.0F, 0.0F, 10.0F));
  for (const glm::vec3 &edge : {glm::vec3(16, 0, -5), {-16, 3, -1}, {5, 10, -9}, {-3, -10, -2}}) {
    // A pixel has an edge of 0.2 m.
    const glm::vec3 outward =
        glm::normalize(std::abs(edge.x) == 16.0F ? glm::vec3(edge.x, 0, 0) : glm::vec3(0, edge.y, 0));
    std::vector<scene::PlacedLamp> placed(1);
    placed[0].kind = scene::LampKind::Point;
    placed[0].range = 0.02F;
    placed[0].world_from_lamp[3] = glm::dvec4(edge + 0.09F * outward, 1.0);
    const Lamps lamps = make_lamps(placed);
    LightClusters clusters;
    clusters.build(lamps, view, view_size_px, scene::Bounds());
    expect_complete(lamps, clusters, edge + 0.09F * outward, "edge");
  }
}

// There the rounding of coordinates is as wide as parts of the view.
TEST(LightClusters, ListLampsFarFromTheOrigin)
{
  constexpr glm::ivec2 view_size_px(160, 100);
  RandomValues random(6);
  const glm::vec3 eye(5e4F, 2e4F, -3e4F);
  const draw::View view(glm::lookAt(eye, eye + glm::vec3(0.3F, 0.2F, -1), {0, 1, 0}),
                        draw::perspective(0.01F, 0.01F, 1.0F, 1000.0F));
  const glm::dmat4 world_from_view = glm::inverse(glm::dmat4(view.view_from_world()));
  std::vector<scene::PlacedLamp> placed(400);
  for (scene::PlacedLamp &lamp : placed) {
    lamp.kind = scene::LampKind::Point;
    lamp.range = 1e-3F;
    const double depth = random.in(50.0F, 200.0F);
    lamp.world_from_lamp[3] =
        world_from_view * glm::dvec4(0.009 * depth * random.in(-1, 1), 0.009 * depth * random.in(-1, 1), -depth, 1.0);
  }
  const Lamps lamps = make_lamps(placed);
  LightClusters clusters;
  clusters.build(lamps, view, view_size_px, scene::Bounds());
  for (const shared::LightData &light : lamps.lights) {
    expect_complete(lamps, clusters, light.position_ws, "far");
  }
}

TEST(LightClusters, ListsAscendAndCountTheLightsWithCubes)
{
  RandomValues random(3);
  std::vector<scene::PlacedLamp> placed = random_lamps(random, 200, glm::vec3(0), 10.0F);
  LightClusters clusters;
  for (const bool has_everywhere : {true, false}) {
    for (scene::PlacedLamp &lamp : placed) {
      lamp.range = has_everywhere ? lamp.range : 8.0F;
    }
    const Lamps lamps = make_lamps(placed);
    ASSERT_EQ(lamps.cube_everywhere_count > 0, has_everywhere);
    ASSERT_EQ(lamps.other_everywhere_count > 0, has_everywhere);
    clusters.build(lamps, views_at({0, 0, 8}, {0, 0, -1}, 10.0F)[0].view, {160, 100}, scene::Bounds());
    const std::span<const float> values = clusters.values();
    EXPECT_EQ(values[0], float(2 * clusters.froxel_count() + 1));
    EXPECT_EQ(std::size_t(values[2 * clusters.froxel_count()]), values.size());
    std::set<float> listed;
    for (std::size_t froxel = 0; froxel < clusters.froxel_count(); froxel++) {
      const auto first = std::size_t(values[2 * froxel]);
      const std::span<const float> list = values.subspan(first, std::size_t(values[2 * froxel + 2]) - first);
      EXPECT_TRUE(std::ranges::is_sorted(list, std::ranges::less_equal()));
      EXPECT_EQ(values[2 * froxel + 1],
                float(std::ranges::count_if(list, [&](float light) { return light < float(lamps.cube_light_count); })));
      listed.insert(list.begin(), list.end());
    }
    EXPECT_FALSE(listed.empty());
    for (const float light : listed) {
      EXPECT_FALSE(lamps.reaches.at(std::size_t(light)).is_everywhere());
    }
    EXPECT_EQ(clusters.entry_count(), values.size() - 2 * clusters.froxel_count() - 1);
  }
}

/** \a count lamps with a range of 12 m, with the density of 128 lamps in a hall of 90 m. */
std::vector<scene::PlacedLamp> hall_lamps(int count)
{
  RandomValues random(4);
  const float edge = 90.0F * std::sqrt(float(count) / 128.0F);
  std::vector<scene::PlacedLamp> lamps(std::size_t(count), scene::PlacedLamp{});
  for (scene::PlacedLamp &lamp : lamps) {
    lamp.kind = scene::LampKind::Point;
    lamp.range = 12.0F;
    // Compilers evaluate arguments in different orders.
    const float z = random.in(-edge, 0.0F);
    const float x = random.in(0.0F, edge);
    lamp.world_from_lamp[3] = glm::dvec4(x, 4.0F, z, 1.0F);
  }
  return lamps;
}

// The work of a pixel: it does not grow with the number of lamps, and is little more than that of the lamps that reach
// it.
TEST(LightClusters, ListsOfAGrowingHallStayShort)
{
  constexpr glm::ivec2 view_size_px(320, 180);
  LightClusters clusters;
  for (const int count : {128, 1024, 4096}) {
    const std::vector<scene::PlacedLamp> placed = hall_lamps(count);
    const Lamps lamps = make_lamps(placed);
    const float edge = 90.0F * std::sqrt(float(count) / 128.0F);
    const glm::vec3 eye(0.5F * edge, 2.0F, 0.0F);
    const draw::View view(glm::lookAt(eye, eye + glm::vec3(0, -0.05F, -1), {0, 1, 0}),
                          draw::perspective(0.7F, 0.4F, 0.1F, std::numeric_limits<float>::infinity()));
    clusters.build(lamps, view, view_size_px, scene::Bounds());
    // Points of the ground.
    const glm::dmat4 world_from_clip = glm::inverse(glm::dmat4(view.clip_from_world()));
    double listed = 0.0;
    double reaching = 0.0;
    int points = 0;
    for (int y = 0; y < view_size_px.y; y += 6) {
      for (int x = 0; x < view_size_px.x; x += 6) {
        const glm::dvec2 ndc = 2.0 * (glm::dvec2(x, y) + 0.5) / glm::dvec2(view_size_px) - 1.0;
        const glm::dvec4 through = world_from_clip * glm::dvec4(ndc, 1.0, 1.0);
        const glm::dvec3 ray = glm::dvec3(through) / through.w - glm::dvec3(eye);
        const double distance = -double(eye.y) / ray.y;
        const glm::vec3 point(glm::dvec3(eye) + distance * ray);
        if (distance < 0.0 || point.z < -edge || point.x < 0.0F || point.x > edge) {
          continue;
        }
        points++;
        listed += double(list_at(clusters, point).size());
        reaching += double(std::ranges::count_if(
            lamps.lights, [&](const shared::LightData &light) { return gives_light(light, point); }));
      }
    }
    ASSERT_GT(points, 200);
    // Measured: 1.34, 1.39 and 1.57 times. If spheres are not cut by rows: 1.43, 1.51 and 1.76.
    EXPECT_LT(listed, 1.65 * reaching) << count << " lamps: " << listed / points << " are listed at a point, "
                                       << reaching / points << " reach it";
  }
}

// A lamp that reaches far beyond the scene does not widen the slices of the others.
TEST(LightClusters, SlicesDivideTheVisibleDepths)
{
  constexpr glm::ivec2 view_size_px(320, 180);
  constexpr float edge = 20.0F;
  RandomValues random(8);
  std::vector<scene::PlacedLamp> placed(200);
  for (scene::PlacedLamp &lamp : placed) {
    lamp.kind = scene::LampKind::Point;
    lamp.range = 1.0F;
    lamp.world_from_lamp[3] = glm::dvec4(random.in_box(0.5F * edge), 1.0);
  }
  scene::PlacedLamp far = placed[0];
  far.range = 1e4F;
  const auto mean_length = [&](const scene::Bounds &bounds_ws, float view_far) {
    const draw::View view(glm::lookAt(glm::vec3(0, 0, 0.6F * edge), glm::vec3(0), glm::vec3(0, 1, 0)),
                          draw::perspective(0.7F, 0.4F, 0.1F, view_far));
    LightClusters clusters;
    clusters.build(make_lamps(placed), view, view_size_px, bounds_ws);
    RandomValues points(9);
    std::size_t sum = 0;
    for (int i = 0; i < 1000; i++) {
      sum += list_at(clusters, points.in_box(0.5F * edge)).size();
    }
    return double(sum) / 1000.0;
  };
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const scene::Bounds hall{glm::vec3(-0.5F * edge), glm::vec3(0.5F * edge)};
  const double few = mean_length(hall, infinity);
  placed.push_back(far);
  EXPECT_LT(mean_length(hall, infinity), 1.2 * few + 1.0) << "bounds";
  // Without bounds, slices start at the near plane, before the lamps. Measured: 1.39 times.
  EXPECT_LT(mean_length({}, 1.1F * edge), 1.5 * few + 1.0) << "far plane";
  EXPECT_GT(mean_length({}, infinity), 2.0 * few + 1.0) << "the case is not one in which the bounds matter";
}

TEST(LightClusters, CoarseGridsBoundTheMemory)
{
  RandomValues random(5);
  std::vector<scene::PlacedLamp> placed = hall_lamps(10000);
  for (scene::PlacedLamp &lamp : placed) {
    lamp.range = 1e4F;
  }
  const Lamps lamps = make_lamps(placed);
  LightClusters clusters;
  const NamedView named = views_at({0, 0, 8}, {0, 0, -1}, 100.0F)[1];
  clusters.build(lamps, named.view, {320, 180}, scene::Bounds());
  EXPECT_LE(clusters.values().size(), LightClusters::values_max);
  EXPECT_GE(clusters.entry_count(), placed.size());
  for (int i = 0; i < 3; i++) {
    expect_complete(lamps, clusters, random_point(random, named, {320, 180}), named.name);
  }
  // A device with small texture buffers.
  clusters.build(lamps, named.view, {320, 180}, scene::Bounds(), 10003);
  EXPECT_EQ(clusters.values().size(), 10003U);
  expect_complete(lamps, clusters, random_point(random, named, {320, 180}), named.name);
}

TEST(LightClusters, HaveOneFroxelIfNoLampIsInTheView)
{
  std::vector<scene::PlacedLamp> placed = hall_lamps(4);
  LightClusters clusters;
  for (const NamedView &named : views_at({0, 1000, 0}, {0, 1, 0}, 1.0F)) {
    clusters.build(make_lamps(placed), named.view, {320, 180}, scene::Bounds());
    EXPECT_EQ(clusters.froxel_count(), 1U) << named.name;
    EXPECT_TRUE(list_at(clusters, {0, 1001, 0}).empty()) << named.name;
  }
}

}  // namespace
}  // namespace gnomon::eevee
