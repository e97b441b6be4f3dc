// SPDX-License-Identifier: MIT
#include "shadows/shadow_plan.hh"

#include "eevee_esm_shared.h"
#include "gpu/gpu_testing.hh"

#include <random>
#include <set>

namespace gnomon::eevee {
namespace {

ShadowLamp lamp_of(std::uint64_t key, scene::LampKind kind = scene::LampKind::Point)
{
  ShadowLamp lamp;
  lamp.key = key;
  lamp.name = "lamp " + std::to_string(key);
  lamp.kind = kind;
  lamp.spot_outer_angle = 0.5F;
  return lamp;
}

std::vector<ShadowLamp> point_lamps(std::uint64_t count)
{
  std::vector<ShadowLamp> lamps;
  for (std::uint64_t key = 0; key < count; key++) {
    lamps.push_back(lamp_of(key));
  }
  return lamps;
}

std::size_t cube_bytes(int size_px)
{
  return std::size_t(6) * std::size_t(size_px) * std::size_t(size_px) * sizeof(float);
}

TEST(LayerRuns, KeepTheirPlacesAndNeverOverlap)
{
  std::mt19937 random(3);
  LayerRuns runs;
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::pair<int, int>> known;
  for (int edit = 0; edit < 3000; edit++) {
    // Lamps of two viewports.
    const LayerOwner owner{random() % 6, random() % 2};
    const int count = int(random() % 5);
    const int first = runs.place(owner, count);
    ASSERT_EQ(runs.count_of(owner), count);
    const std::pair key(owner.lamp, owner.viewport);
    if (count > 0 && known.contains(key) && known[key].second >= count) {
      ASSERT_EQ(first, known[key].first) << "a run that does not grow stays";
    }
    known.erase(key);
    if (count > 0) {
      known[key] = {first, count};
    }
    std::set<int> used;
    int end = 0;
    for (const auto &[run_owner, run] : known) {
      for (int layer = run.first; layer < run.first + run.second; layer++) {
        ASSERT_TRUE(used.insert(layer).second) << "layer " << layer << " has two owners";
      }
      end = std::max(end, run.first + run.second);
    }
    ASSERT_EQ(runs.end(), end);
  }
}

TEST(ShadowPlan, KeepsPlacesAndSizesOfTheOtherLamps)
{
  std::vector<ShadowLamp> lamps = point_lamps(6);
  lamps[2] = lamp_of(2, scene::LampKind::Sun);
  lamps[4].shadow.kind = scene::ShadowKind::Evsm;
  const ShadowPlan before = plan_shadows(lamps, {}, {}, {});
  const auto expect_kept = [&](const std::vector<ShadowLamp> &edited) {
    const ShadowPlan after = plan_shadows(edited, {}, {}, before);
    for (const ShadowPlace &place : after.places) {
      const auto old = std::ranges::find_if(
          before.places, [&](const ShadowPlace &other) { return lamps[other.lamp].key == edited[place.lamp].key; });
      if (old != before.places.end()) {
        EXPECT_EQ(place.first_layer, old->first_layer);
        EXPECT_EQ(place.given.size_px, old->given.size_px);
        EXPECT_EQ(place.technique, old->technique);
      }
    }
  };
  for (std::size_t i = 0; i < lamps.size(); i++) {
    std::vector<ShadowLamp> fewer = lamps;
    fewer.erase(fewer.begin() + std::ptrdiff_t(i));
    expect_kept(fewer);
    std::vector<ShadowLamp> more = lamps;
    more.insert(more.begin() + std::ptrdiff_t(i), lamp_of(77));
    expect_kept(more);
    std::vector<ShadowLamp> renamed = lamps;
    renamed[i].name = "another";
    expect_kept(renamed);
  }
}

TEST(ShadowPlan, GapsAreClosedToFitTheMemory)
{
  const ShadowSettings settings{.cube_size_px = 64, .memory_bytes_max = 3 * cube_bytes(64)};
  const ShadowPlan before = plan_shadows(point_lamps(3), settings, {}, {});
  EXPECT_TRUE(before.limits.empty());
  std::vector<ShadowLamp> lamps = point_lamps(3);
  lamps.erase(lamps.begin());
  const ShadowPlan fewer = plan_shadows(lamps, settings, {}, before);
  EXPECT_EQ(fewer.places[0].first_layer, 6) << "the memory holds the gap";
  ShadowSettings less = settings;
  less.memory_bytes_max = 2 * cube_bytes(64);
  const ShadowPlan closed = plan_shadows(lamps, less, {}, fewer);
  EXPECT_TRUE(closed.limits.empty());
  EXPECT_EQ(closed.places[0].first_layer, 0);
  EXPECT_EQ(closed.places[1].first_layer, 6);
}

TEST(ShadowPlan, BeyondTheLimitsTheLastLampsLoseTheirShadow)
{
  const ShadowPlan plan = plan_shadows(point_lamps(5), {.cube_size_px = 16}, {.array_layers_max = 18}, {});
  ASSERT_EQ(plan.places.size(), 3U);
  EXPECT_EQ(plan.places.back().lamp, 2U);
  ASSERT_EQ(plan.limits.size(), 1U);
  test::expect_contains(plan.limits[0], "'lamp 3', 'lamp 4'");
  const ShadowPlan small =
      plan_shadows(point_lamps(5), {.cube_size_px = 16, .memory_bytes_max = 2 * cube_bytes(16)}, {}, {});
  EXPECT_EQ(small.places.size(), 2U);
}

// The border around an octahedral layer does not scale with it.
TEST(ShadowPlan, NoLampLosesItsShadowForTheBorderOfAnOctahedralLayer)
{
  for (const EsmKernel kernel : {EsmKernel::Disk4, EsmKernel::Separable}) {
    for (std::size_t kib = 10; kib < 4000; kib += 37) {
      ShadowSettings settings{.kind = scene::ShadowKind::Esm, .memory_bytes_max = 1024 * kib};
      settings.esm.kernel = kernel;
      const ShadowPlan plan = plan_shadows(point_lamps(1), settings, {}, {});
      ASSERT_EQ(plan.places.size(), 1U) << kib << " KiB";
      // Bytes of 6 faces, the layer, and two textures of the separable filter.
      const ShadowRequest &given = plan.places[0].given;
      const std::size_t edge = std::size_t(given.octahedral_px + 2 * ESM_BORDER);
      const std::size_t layers = kernel == EsmKernel::Separable ? 3 : 1;
      const std::size_t bytes = cube_bytes(given.size_px) + edge * edge * layers * sizeof(float);
      EXPECT_LE(bytes, settings.memory_bytes_max);
      const bool is_full_size = given.octahedral_px == settings.esm.size_px;
      EXPECT_TRUE(is_full_size || double(bytes) > 0.85 * double(settings.memory_bytes_max))
          << kib << " KiB, of which " << bytes << " bytes are used";
    }
  }
}

}  // namespace
}  // namespace gnomon::eevee
