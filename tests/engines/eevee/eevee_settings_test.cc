// SPDX-License-Identifier: MIT
#include "eevee_settings.hh"

#include "member_count.hh"

#include "gltf_import.hh"
#include "render_display.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <type_traits>

namespace gnomon::eevee {
namespace {

using test::member_count;
using test::row_count;

// A member without a row is in none of the lists that read the rows: add one, or count it here and say why.
// The method, which ShadowSettings::kind selects.
static_assert(member_count<EsmSettings>() == row_count<EsmSettings>() + 1);
// `esm` and `cascades`, which have rows of their own.
static_assert(member_count<ShadowSettings>() ==
              row_count<ShadowSettings>() - row_count<EsmSettings>() - member_count<CascadeSettings>() + 2);
// The shadow, which has rows of its own; the part of the light, the first and the last sample, the probe and the
// surfaces, which a host asks for and which are no settings of a picture.
static_assert(member_count<Settings>() == row_count<Settings>() + 6);
static_assert(member_count<render_scene::Display>() == row_count<render_scene::Display>());
// The folder, whose meaning depends on the host, and two functions.
static_assert(member_count<gltf::ImportOptions>() == row_count<gltf::ImportOptions>() + 3);

/** Sets \a value to \a number. false: it has no number. */
template <typename Value>
bool set_setting(Value &value, double number)
{
  if constexpr (requires { value.has_value(); }) {
    value.emplace();
    return set_setting(*value, number);
  }
  else if constexpr (std::is_same_v<Value, bool> || !std::is_arithmetic_v<Value>) {
    return false;
  }
  else {
    const bool is_stored =
        std::is_floating_point_v<Value> || (number >= double(std::numeric_limits<Value>::lowest()) &&
                                            number <= double(std::numeric_limits<Value>::max()) && !std::isnan(number));
    value = is_stored ? Value(number) : Value();
    return is_stored;
  }
}

template <typename T>
class SettingRows : public testing::Test {
};
using WithRows = testing::Types<Settings, ShadowSettings, render_scene::Display, gltf::ImportOptions>;
TYPED_TEST_SUITE(SettingRows, WithRows);

TYPED_TEST(SettingRows, HaveANameASentenceAndLimitsThatTheDefaultKeeps)
{
  std::set<std::string_view> names;
  EXPECT_EQ(scene::limit_fault(TypeParam()), "");
  TypeParam::for_each_property([&](const auto &row) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(row.sentence.ends_with('.')) << row.name;
    EXPECT_LT(row.min, row.max) << row.name;
    TypeParam settings;
    auto &value = row.access(settings);
    for (const double inside : {row.min, row.max}) {
      if (std::abs(inside) < 1e30 && set_setting(value, inside)) {
        EXPECT_EQ(scene::limit_fault(settings), "") << row.name;
      }
    }
    const double step = 0.01 * std::max(100.0, std::max(std::abs(row.min), std::abs(row.max)));
    for (const double outside : {row.min - step, row.max + step, std::nan("")}) {
      if (row.max < 1e30 && set_setting(value, outside) && !row.allows(outside)) {
        EXPECT_EQ(scene::limit_fault(settings).find(std::string(row.name) + ' '), 0U) << row.name << ' ' << outside;
      }
    }
  });
}

TEST(SettingRowsTest, NamesOfASettingsPartsDiffer)
{
  std::set<std::string_view> names;
  std::set<std::string_view> keys;
  const auto add = [&](const auto &row) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(keys.insert(row.key_or_name()).second) << row.key_or_name();
  };
  Settings::for_each_property(add);
  ShadowSettings::for_each_property(add);
  render_scene::Display::for_each_property(add);
}

TEST(SettingRowsTest, ALampAndAllLampsHaveTheSameLimits)
{
  int common_count = 0;
  scene::LampShadow::for_each_property([&](const auto &of_lamp) {
    ShadowSettings::for_each_property([&](const auto &of_all) {
      if (of_lamp.name == of_all.name || "shadow_" + std::string(of_all.name) == of_lamp.name) {
        common_count++;
        EXPECT_EQ(of_lamp.min, of_all.min) << of_all.name;
        EXPECT_EQ(of_lamp.max, of_all.max) << of_all.name;
        EXPECT_EQ(of_lamp.unit, of_all.unit) << of_all.name;
      }
    });
  });
  EXPECT_EQ(common_count, 6);
}

TEST(SettingRowsTest, ATextNamesEachKernelAndNoOther)
{
  for (const char *text : {"1", "3x3", "5x5", "disk:1", "disk:64"}) {
    ASSERT_TRUE(pcf_kernel_of(text)) << text;
    EXPECT_EQ(text_of(*pcf_kernel_of(text)), text);
  }
  for (const char *text : {"", "2x2", "7x7", "disk", "disk:", "disk:0", "disk:65", "disk:4x", "disk:-1", "-1x-1"}) {
    EXPECT_FALSE(pcf_kernel_of(text)) << text;
  }
}

}  // namespace
}  // namespace gnomon::eevee
