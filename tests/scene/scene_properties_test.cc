// SPDX-License-Identifier: MIT
#include "member_count.hh"

#include "scene.hh"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>
#include <type_traits>
#include <utility>

namespace gnomon::scene {
namespace {

// ---- Each member has a row ----

using test::member_count;
using test::row_count;

// A member without a row is in none of the lists that read the rows: add one, or count it here and say why.
// The shadow has rows of its own.
static_assert(member_count<Lamp>() == row_count<Lamp>() + 1);
static_assert(member_count<LampShadow, true>() == row_count<LampShadow>());
static_assert(member_count<Camera>() == row_count<Camera>());
// The surface function.
static_assert(member_count<Material>() == row_count<Material>() + texture_inputs.size() + 1);
// The matrix, the meshes, the lamp and the camera.
static_assert(member_count<Node>() == row_count<Node>() + 4);
// The picture.
static_assert(member_count<World>() == row_count<World>() + 1);
// A slot has constructors. The texture, of two numbers; all members are as wide as their numbers.
static_assert(sizeof(TextureSlot) == sizeof(Handle<Texture>) + sizeof(int) + 5 * sizeof(float) &&
              row_count<TextureSlot>() == 4);

// ---- Rows are whole, and an edit of each is checked and found ----

/** Calls \a visit with each row of a T and the part of \a thing that has it: a lamp's shadow or the thing itself. */
template <typename T, typename Visit>
void for_each_row(T &thing, Visit &&visit)
{
  T::for_each_property([&](const auto &row) { visit(row, thing); });
  if constexpr (std::is_same_v<T, Lamp>) {
    LampShadow::for_each_property([&](const auto &row) { visit(row, thing.shadow); });
  }
}

template <typename T>
class SceneProperties : public testing::Test {
};
using Things = testing::Types<Lamp, Camera, Material, Node, World, TextureSlot>;
TYPED_TEST_SUITE(SceneProperties, Things);

TYPED_TEST(SceneProperties, HaveANameAKeyAndASentenceOfTheirOwn)
{
  TypeParam thing;
  std::set<std::string_view> names;
  std::set<std::string_view> keys;
  for_each_row(thing, [&](const auto &row, const auto &part) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(keys.insert(row.key_or_name()).second) << row.key_or_name();
    EXPECT_TRUE(row.sentence.ends_with('.')) << row.name;
    EXPECT_LT(row.min, row.max) << row.name;
    for_each_number(part.*row.member, [&](double value) {
      EXPECT_TRUE(row.allows(value)) << row.name << ": the default " << value << " is not " << range_text(row);
    });
    if (row.first != 0.0) {
      EXPECT_TRUE(row.allows(row.first)) << row.name;
    }
  });
}

/** Sets the number that \a value is, or the first one that it has. */
template <typename Value>
bool set_number(Value &value, double number)
{
  if constexpr (requires { value.has_value(); }) {
    typename Value::value_type inner{};
    const bool is_set = set_number(inner, number);
    value = inner;
    return is_set;
  }
  else if constexpr (requires { value.x; }) {
    value.x = float(number);
    return true;
  }
  else if constexpr (std::is_same_v<Value, int>) {
    value = int(number);
    return true;
  }
  else if constexpr (std::is_same_v<Value, float>) {
    value = float(number);
    return true;
  }
  return false;
}

template <typename T>
bool refuses(T thing)
{
  Scene scene;
  try {
    scene.add(std::move(thing));
    return false;
  }
  catch (const InvalidEdit &) {
    return true;
  }
}

template <typename T>
class ScenePropertyEdits : public testing::Test {
};
using Edited = testing::Types<Lamp, Camera, Material>;
TYPED_TEST_SUITE(ScenePropertyEdits, Edited);

TYPED_TEST(ScenePropertyEdits, OutsideOfTheLimitsAreRefusedAndNamedAndInsideRaiseTheAspect)
{
  const auto check = [](TypeParam thing) {
    for_each_row(thing, [&](const auto &row, auto &part) {
      if (!row.has_kind(kind_of(thing))) {
        return;
      }
      auto &member = part.*row.member;
      const auto before = member;
      using Value = std::decay_t<decltype(member)>;
      constexpr bool is_whole = std::is_same_v<Value, int> || std::is_same_v<Value, std::optional<int>>;
      // Larger than the spacing of floats there.
      const double step = is_whole ? 1.0 : 0.01 * std::max(1.0, std::abs(row.min));
      const double below = row.min - step;
      if (set_number(member, below)) {
        EXPECT_TRUE(refuses(thing)) << row.name << " below";
      }
      if (set_number(member, 1.01 * row.max + step)) {
        EXPECT_TRUE(refuses(thing)) << row.name << " above";
      }
      if (!is_whole && set_number(member, std::nan(""))) {
        EXPECT_TRUE(refuses(thing)) << row.name;
      }
      member = before;
      const TypeParam original = thing;
      if (set_number(member, row.max) && member != before) {
        Scene scene;
        const auto handle = scene.add(original);
        scene.replace(handle, thing);
        const auto aspect = typename TypeParam::Aspect(row.aspect);
        EXPECT_EQ(scene.pool<TypeParam>().revision(handle, aspect), scene.revision()) << row.name;
      }
      member = before;
    });
  };
  if constexpr (std::is_same_v<TypeParam, Lamp>) {
    for (std::size_t kind = 0; kind < words<LampKind>.size(); kind++) {
      check({.kind = LampKind(kind)});
    }
  }
  else if constexpr (std::is_same_v<TypeParam, Camera>) {
    check({.kind = CameraKind::Perspective});
    check({.kind = CameraKind::Orthographic});
  }
  else {
    check({});
  }
}

}  // namespace
}  // namespace gnomon::scene
