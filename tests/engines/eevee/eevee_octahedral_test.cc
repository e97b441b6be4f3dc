// SPDX-License-Identifier: MIT
#include "shadows/shadow_octahedral_store.hh"

#include "eevee_esm_shared.h"
#include "gpu/gpu_testing.hh"

#include <cmath>
#include <limits>

namespace gnomon::eevee {
namespace {

EsmLamp lamp(const std::string &name, float range, const EsmSettings &settings = {})
{
  return {name, range, settings, std::hash<std::string>{}(name)};
}

class OctahedralStoreTest : public testing::Test {
 protected:
  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  ShaderCache shaders;
  OctahedralStore store;
};

TEST_F(OctahedralStoreTest, MakesOnlyWhatIsAskedFor)
{
  EXPECT_FALSE(store.sync(*device, shaders, {}));
  EXPECT_EQ(device->live_resources().size(), 0U);
  const EsmSettings settings{.size_px = 64, .format = EsmFormat::Float, .kernel = EsmKernel::Disk4};
  EXPECT_TRUE(store.sync(*device, shaders, {{lamp("a", 10.0F, settings)}}));
  EXPECT_EQ(store.size_bytes(), 66U * 66U * 4U);
  EXPECT_EQ(shaders.size(), 1U);
  EXPECT_EQ(store.texture(0).desc().format, gpu::Format::R32F);
  store.sync(*device, shaders, {});
  EXPECT_EQ(store.size_bytes(), 0U);
}

TEST_F(OctahedralStoreTest, ReportsWhetherLayersMustBeRecordedAgain)
{
  std::vector<EsmLamp> lamps = {lamp("a", 10.0F), lamp("b", 20.0F)};
  EXPECT_TRUE(store.sync(*device, shaders, lamps));
  EXPECT_FALSE(store.sync(*device, shaders, lamps));
  lamps[1].settings.exponent = 3.0F;
  EXPECT_TRUE(store.sync(*device, shaders, lamps));
  lamps[1].settings.kernel = EsmKernel::Separable;
  EXPECT_TRUE(store.sync(*device, shaders, lamps));
  EXPECT_FALSE(store.sync(*device, shaders, lamps));
  EXPECT_FALSE(store.must_record(0));
  lamps[1].settings.bias = 2.0F;
  EXPECT_FALSE(store.sync(*device, shaders, lamps)) << "lookups alone read the bias";
  lamps.push_back(lamp("c", 5.0F));
  EXPECT_TRUE(store.sync(*device, shaders, lamps));
  EXPECT_FALSE(store.must_record(0) || store.must_record(1));
  EXPECT_TRUE(store.must_record(2));
  const int layer = store.data(2).layer;
  lamps.erase(lamps.begin());
  EXPECT_FALSE(store.sync(*device, shaders, lamps)) << "a removed lamp leaves the others' layers where they are";
  EXPECT_EQ(store.data(1).layer, layer);
}

TEST_F(OctahedralStoreTest, VariancesHaveTwoChannelsInAnArrayOfTheirOwn)
{
  const EsmSettings plain{.size_px = 64, .format = EsmFormat::Float};
  EsmSettings variance = plain;
  variance.method = EsmMethod::Evsm;
  // Also if 16 bits are requested, which cannot represent them.
  variance.format = EsmFormat::Half;
  store.sync(*device, shaders, {{lamp("a", 10.0F, plain), lamp("b", 10.0F, variance)}});
  EXPECT_TRUE(store.has_variance());
  EXPECT_EQ(store.texture(0).desc().format, gpu::Format::R32F);
  EXPECT_EQ(store.texture(1).desc().format, gpu::Format::RG32F);
  EXPECT_EQ(store.data(1).layer, 0);
  EXPECT_EQ(store.size_bytes(), 66U * 66U * (4U + 8U));
  EXPECT_TRUE(store.limits().empty());
  variance.kernel = EsmKernel::Separable;
  store.sync(*device, shaders, {{lamp("b", 10.0F, variance)}});
  EXPECT_EQ(store.size_bytes(), (66U * 66U + 2U * 64U * 64U) * 8U);
  store.sync(*device, shaders, {{lamp("a", 10.0F, plain)}});
  EXPECT_FALSE(store.has_variance());
}

// hazards.md: more lamps than slots, the lamp past the maximum is dropped silently.
TEST_F(OctahedralStoreTest, LampsPastTheLimitAreNamedAndTheOthersUnchanged)
{
  std::vector<EsmLamp> lamps;
  for (int i = 0; i < ESM_MAX + 2; i++) {
    lamps.push_back(lamp("lamp " + std::to_string(i), 10.0F, {.size_px = 4}));
  }
  store.sync(*device, shaders, lamps);
  EXPECT_EQ(store.size(), std::size_t(ESM_MAX));
  ASSERT_EQ(store.limits().size(), 1U);
  EXPECT_EQ(store.limits()[0],
            "2 lamps lost their shadow, as 255 octahedral layers are the most: 'lamp 255', 'lamp 256'");
  EXPECT_EQ(store.data(ESM_MAX - 1).layer, ESM_MAX - 1);

  const auto small = gpu::create_null_device({.array_layers_max = 3});
  ShaderCache small_shaders;
  OctahedralStore small_store;
  small_store.sync(*small, small_shaders, std::span(lamps).first(4));
  EXPECT_EQ(small_store.size(), 3U);
  test::expect_contains(small_store.limits().at(0), "'lamp 3'");
}

// hazards.md: fp16 storage of linear distance: format chosen by range and exponent, error reported.
TEST_F(OctahedralStoreTest, FormatFollowsRangeAndExponentAndItsErrorIsReported)
{
  const auto with = [](float exponent, std::optional<EsmFormat> format) {
    return EsmSettings{.exponent = exponent, .size_px = 64, .format = format};
  };
  store.sync(
      *device, shaders,
      {{lamp("near", 10.0F, with(5.0F, std::nullopt)), lamp("far", 40.0F, with(80.0F, std::nullopt)),
        lamp("forced", 40.0F, with(80.0F, EsmFormat::Half)), lamp("asked", 1e3F, with(1e4F, EsmFormat::Float))}});
  EXPECT_EQ(store.data(0).format, ESM_HALF);
  EXPECT_EQ(store.data(1).format, ESM_FLOAT);
  EXPECT_EQ(store.data(2).format, ESM_HALF);
  EXPECT_EQ(store.data(3).format, ESM_FLOAT);
  // Layers are counted by array.
  EXPECT_EQ(store.data(1).layer, 0);
  EXPECT_EQ(store.data(2).layer, 1);
  ASSERT_EQ(store.limits().size(), 1U);
  // 1 - exp(-80 · 40 / 8192).
  EXPECT_EQ(
      store.limits()[0],
      "lamp 'forced': 16 bits round its shadow by up to 0.32 at an exponent of 80/m over 40 m; 32 bits would not");
}

// hazards.md: sharpness depends on scene units.
TEST_F(OctahedralStoreTest, DerivedSettingsScaleWithTheScene)
{
  for (const float range : {0.1F, 1.0F, 20.0F, 1e3F}) {
    const EsmSettings wide{.filter_angle = 0.1F, .size_px = 256};
    const EsmSettings variance{.method = EsmMethod::Evsm, .filter_angle = 0.01F, .size_px = 256};
    store.sync(*device, shaders,
               {{lamp("a", range, {.size_px = 256}), lamp("b", range, wide), lamp("c", range, variance)}});
    const float texel = std::sqrt(4.0F * 3.14159265F) / 256.0F;
    EXPECT_FLOAT_EQ(store.data(0).filter_angle, 0.5F * texel);
    const auto steepness = [&](std::size_t index) { return store.data(index).exponent * store.data(index).range; };
    EXPECT_NEAR(steepness(0), 1.0F / texel, 1e-3F) << "the scene's unit makes no difference";
    EXPECT_NEAR(steepness(1), 1.0F / 0.1F, 1e-3F);
    EXPECT_NEAR(steepness(2), 0.125F / 0.01F, 1e-3F);
  }
}

TEST_F(OctahedralStoreTest, BadSettingsAreRefusedByNameAndLeaveTheStoreAsItWas)
{
  store.sync(*device, shaders, {{lamp("good", 10.0F)}});
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const auto refused = [&](const EsmLamp &bad, std::string_view part) {
    const std::string message = test::error_of([&] { store.sync(*device, shaders, {{lamp("good", 10.0F), bad}}); });
    test::expect_contains(message, "lamp 'bad'");
    test::expect_contains(message, part);
    EXPECT_EQ(store.size(), 1U);
  };
  for (const float range : {0.0F, -1.0F, nan, infinity}) {
    refused(lamp("bad", range), "range");
  }
  for (const float exponent : {0.0F, 0.009F, 1.1e4F, nan}) {
    refused(lamp("bad", 10.0F, {.exponent = exponent}), "exponent");
  }
  for (const float angle : {-0.1F, 0.8F, nan}) {
    refused(lamp("bad", 10.0F, {.filter_angle = angle}), "shadow_filter_angle");
  }
  for (const int size : {0, 3, 8193}) {
    refused(lamp("bad", 10.0F, {.size_px = size}), "size");
  }
  for (const float bias : {-1.0F, nan, infinity}) {
    refused(lamp("bad", 10.0F, {.bias = bias}), "bias");
  }
}

}  // namespace
}  // namespace gnomon::eevee
