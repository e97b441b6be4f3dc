// SPDX-License-Identifier: MIT
#include "member_count.hh"

#include "view_error_estimate.hh"
#include "view_history.hh"
#include "view_navigation.hh"
#include "view_properties.hh"
#include "view_script.hh"

#include "eevee_settings.hh"

#include <gtest/gtest.h>
#include <glm/gtc/matrix_transform.hpp>

#include <sys/stat.h>
#include <unistd.h>
#include <filesystem>
#include <random>
#include <set>

namespace gnomon::view {
namespace {

TEST(ViewHistoryTest, EachGestureIsUndoneAndRedoneAsOneAndANewEditForgetsWhatWasUndone)
{
  scene::Scene scene;
  History history;
  const auto node = scene.add(scene::Node{.name = "node"});
  const auto lamp = scene.add(scene::Lamp{.name = "lamp"});
  for (const float intensity : {2.0F, 3.0F, 4.0F}) {
    history.edit(scene, lamp, [&](scene::Lamp &edited) { edited.intensity = intensity; });
  }
  EXPECT_EQ(history.undo_count(), 1U);
  history.edit(scene, node, [](scene::Node &edited) { edited.is_visible = false; });
  history.end_gesture();
  history.edit(scene, node, [](scene::Node &edited) { edited.name = "other"; });
  history.set_world(scene, scene::World{.strength = 2.0F});
  history.edit(scene, node, [](scene::Node & /*edited*/) {});
  EXPECT_EQ(history.undo_count(), 4U);
  const auto camera = scene.add(scene::Camera{.near = 1.0F});
  history.edit(scene, camera, [](scene::Camera &edited) { edited.near = 2.0F; });
  EXPECT_TRUE(history.undo(scene));
  EXPECT_EQ(scene.cameras()[camera].near, 1.0F);

  EXPECT_TRUE(history.undo(scene));
  EXPECT_FALSE(scene.world());
  EXPECT_TRUE(history.undo(scene));
  EXPECT_EQ(scene.nodes()[node].name, "node");
  EXPECT_FALSE(scene.is_visible(node));
  EXPECT_TRUE(history.undo(scene));
  EXPECT_TRUE(scene.is_visible(node));
  EXPECT_TRUE(history.undo(scene));
  EXPECT_EQ(scene.lamps()[lamp].intensity, 1.0F);
  EXPECT_FALSE(history.undo(scene));
  EXPECT_TRUE(history.redo(scene));
  EXPECT_EQ(scene.lamps()[lamp].intensity, 4.0F);
  history.edit(scene, lamp, [](scene::Lamp &edited) { edited.intensity = 5.0F; });
  EXPECT_EQ(history.redo_count(), 0U);
  EXPECT_TRUE(history.undo(scene));
  EXPECT_EQ(scene.lamps()[lamp].intensity, 4.0F);
}

TEST(ViewHistoryTest, TheOldestChangesAreForgotten)
{
  scene::Scene scene;
  History history;
  const auto lamp = scene.add(scene::Lamp{.intensity = 0.0F});
  for (std::size_t i = 1; i <= History::step_max + 5; i++) {
    history.edit(scene, lamp, [&](scene::Lamp &edited) { edited.intensity = float(i); });
    history.end_gesture();
  }
  EXPECT_EQ(history.undo_count(), History::step_max);
  while (history.undo(scene)) {
  }
  EXPECT_EQ(scene.lamps()[lamp].intensity, 5.0F);
  while (history.redo(scene)) {
  }
  EXPECT_EQ(scene.lamps()[lamp].intensity, float(History::step_max + 5));
}

TEST(ViewHistoryTest, AnInvalidEditChangesNothingAndIsNotRemembered)
{
  scene::Scene scene;
  History history;
  const auto node = scene.add(scene::Node{.name = "node"});
  EXPECT_THROW(history.edit(scene, node, [](scene::Node &edited) { edited.parent_from_node[3][0] = NAN; }),
               scene::InvalidEdit);
  EXPECT_EQ(history.undo_count(), 0U);
}

TEST(ViewErrorEstimateTest, OfIndependentSamplesItIsTheirRmseOrMore)
{
  constexpr std::size_t pixels = 20000;
  std::mt19937 random(1);
  std::normal_distribution<float> sample(0.5F, 0.2F);
  std::vector<float> sum(4 * pixels);
  ErrorEstimate estimate;
  int last = 0;
  for (int count = 1; count <= 40; count++) {
    for (std::size_t i = 0; i < sum.size(); i++) {
      // Alpha is not counted.
      sum[i] += i % 4 == 3 ? float(count) : sample(random);
    }
    EXPECT_EQ(estimate.is_due(count), count >= 2 * std::max(last, 1)) << count;
    // Pictures may come late.
    if (count != 2 && count != 4 && count != 13 && count != 40) {
      continue;
    }
    std::vector<float> mean = sum;
    for (float &value : mean) {
      value /= float(count);
    }
    estimate.add(count, std::move(mean));
    EXPECT_EQ(estimate.value().has_value(), last > 0);
    if (last > 0) {
      // The RMS of 60000 normal values has a standard deviation of 0.3 %.
      const double expected = 0.2 * std::sqrt(1.0 / double(last) - 1.0 / double(count));
      EXPECT_NEAR(*estimate.value(), expected, 0.015 * expected) << count;
      EXPECT_GT(*estimate.value(), 0.985 * 0.2 / std::sqrt(double(count))) << count;
    }
    last = count;
  }
  estimate.restart();
  EXPECT_FALSE(estimate.value());
  EXPECT_FALSE(estimate.is_due(1));
  EXPECT_TRUE(estimate.is_due(2));
}

TEST(ViewErrorEstimateTest, APictureOfAnotherSizeBeginsAnew)
{
  ErrorEstimate estimate;
  estimate.add(2, std::vector<float>(4, 1.0F));
  estimate.add(4, std::vector<float>(8, 1.0F));
  EXPECT_FALSE(estimate.value());
  estimate.add(8, std::vector<float>(8, 1.0F));
  EXPECT_EQ(estimate.value(), 0.0);
}

/** Where a camera sees a point: x and y in [-1, 1] within the picture of a square. */
glm::dvec2 seen(const scene::PlacedCamera &camera, const glm::dvec3 &point)
{
  const glm::dvec3 view(glm::inverse(camera.world_from_camera) * glm::dvec4(point, 1.0));
  const double half_height = camera.kind == scene::CameraKind::Orthographic
                                 ? double(camera.half_height)
                                 : -view.z * std::tan(0.5 * double(camera.vertical_angle));
  return glm::dvec2(view) / half_height;
}

scene::Bounds box(const glm::vec3 &min, const glm::vec3 &max)
{
  return {min, max};
}

TEST(ViewNavigationTest, TurningAndTheLensKeepThePointInTheMiddleAndFramingShowsAllOfABox)
{
  Navigation navigation;
  const scene::Bounds bounds = box({10, 0, 5}, {14, 1, 6});
  navigation.frame(bounds);
  for (int step = 0; step < 8; step++) {
    navigation.orbit({0.7, 0.3});
    for (int projection = 0; projection < 2; projection++) {
      navigation.toggle_orthographic();
      const scene::PlacedCamera camera = navigation.camera(10.0);
      EXPECT_LT(glm::length(seen(camera, bounds.center())), 1e-5);
      double largest = 0.0;
      for (const double x : {10.0, 14.0}) {
        for (const double y : {0.0, 1.0}) {
          for (const double z : {5.0, 6.0}) {
            largest = std::max(largest, glm::length(seen(camera, {x, y, z})));
          }
        }
      }
      EXPECT_LT(largest, 1.0);
    }
  }
}

TEST(ViewNavigationTest, PanningMovesThePointWithThePointerAndKeysLookAlongTheAxes)
{
  Navigation navigation;
  navigation.frame(box({-1, -1, -1}, {1, 1, 1}));
  navigation.orbit({0.4, -0.2});
  navigation.pan({0.25, -0.1});
  const glm::dvec2 moved = seen(navigation.camera(2.0), {0, 0, 0});
  EXPECT_NEAR(moved.x, 0.5, 1e-6);
  EXPECT_NEAR(moved.y, -0.2, 1e-6);
  const std::pair<Side, glm::dvec3> towards[] = {{Side::Front, {0, 0, -1}}, {Side::Back, {0, 0, 1}},
                                                 {Side::Right, {-1, 0, 0}}, {Side::Left, {1, 0, 0}},
                                                 {Side::Top, {0, -1, 0}},   {Side::Bottom, {0, 1, 0}}};
  for (const auto &[side, direction] : towards) {
    navigation.look_from(side);
    const glm::dvec3 forward(-navigation.camera(1.0).world_from_camera[2]);
    EXPECT_LT(glm::distance(forward, direction), 1e-12) << int(side);
  }
}

TEST(ViewNavigationTest, ASceneCameraIsLookedThroughAsItIs)
{
  scene::PlacedCamera camera;
  camera.world_from_camera = glm::inverse(glm::lookAt(glm::dvec3(3, 4, 5), glm::dvec3(0, 1, 0), glm::dvec3(0, 1, 0)));
  camera.vertical_angle = 0.5F;
  camera.aspect = 1.5F;
  Navigation navigation;
  navigation.look_through(camera, box({-1, -1, -1}, {1, 1, 1}));
  scene::PlacedCamera same = navigation.camera(2.0);
  EXPECT_EQ(same.vertical_angle, camera.vertical_angle);
  EXPECT_EQ(same.aspect, camera.aspect);
  for (int i = 0; i < 4; i++) {
    EXPECT_LT(glm::distance(same.world_from_camera[i], camera.world_from_camera[i]), 1e-12) << i;
  }
  camera.kind = scene::CameraKind::Orthographic;
  camera.half_width = camera.half_height = 3.0F;
  navigation.look_through(camera, box({-1, -1, -1}, {1, 1, 1}));
  same = navigation.camera(2.0);
  EXPECT_NEAR(same.half_height, 3.0F, 1e-5F);
  EXPECT_LT(glm::distance(seen(same, {1, 1, 1}), seen(camera, {1, 1, 1})), 1e-6);
}

TEST(ViewPropertiesTest, APlacementIsReadAndWrittenAndMovingKeepsAShear)
{
  glm::dmat4 matrix = glm::translate(glm::dmat4(1), {1, 2, 3});
  matrix = glm::rotate(matrix, glm::radians(30.0), {0, 0, 1});
  matrix = glm::rotate(matrix, glm::radians(-20.0), {0, 1, 0});
  matrix = glm::rotate(matrix, glm::radians(10.0), {1, 0, 0});
  matrix = glm::scale(matrix, {-2, 3, 0.5});
  Placement placement = placement_of(matrix);
  EXPECT_LT(glm::distance(placement.position, {1, 2, 3}), 1e-12);
  EXPECT_LT(glm::distance(placement.scale, {-2, 3, 0.5}), 1e-12);
  EXPECT_LT(glm::distance(placement.rotation, {10, -20, 30}), 1e-9);
  placement.rotation = {0, 0, 0};
  const glm::dmat4 straight = placed(matrix, placement);
  EXPECT_LT(glm::distance(glm::dvec3(straight[1]), {0, 3, 0}), 1e-12);

  glm::dmat4 sheared(1.0);
  sheared[1][0] = 0.5;
  Placement moved = placement_of(sheared);
  moved.position.x = 7.0;
  glm::dmat4 expected = sheared;
  expected[3][0] = 7.0;
  EXPECT_EQ(placed(sheared, moved), expected);
}

TEST(ViewPropertiesTest, EveryNumberIsWhatWasSetWithinItsLimitsAndEveryChoiceToo)
{
  const auto check = [](auto thing) {
    using T = decltype(thing);
    for (const auto &property : properties<T>().numbers) {
      if (property.absent) {
        property.remove(thing);
        EXPECT_TRUE(property.is_absent(thing)) << property.name;
        const double first = property.get(thing, 0);
        EXPECT_TRUE(first >= property.min && first <= property.max) << property.name << ' ' << first;
        property.set(thing, 0, first);
        EXPECT_FALSE(property.is_absent(thing)) << property.name;
        // A float.
        EXPECT_NEAR(property.get(thing, 0), first, 1e-6 * first) << property.name;
      }
      for (int i = 0; i < property.width; i++) {
        for (const double value : {property.min, property.max, 0.5 * property.min + 0.5 * property.max}) {
          property.set(thing, i, value);
          EXPECT_NEAR(property.get(thing, i), value, 1e-6 * std::abs(value) + 0.5) << property.name;
        }
      }
    }
    for (const auto &property : properties<T>().choices) {
      for (int value = 0; value < int(property.options.size()); value++) {
        property.set(thing, value);
        EXPECT_EQ(property.get(thing), value) << property.name;
      }
    }
  };
  check(scene::Lamp());
  check(ShadowOfLamp());
  check(scene::Camera());
  check(scene::Material());
  check(scene::Node());
  check(scene::World());
  check(Placement());
  check(WindowSettings());
}

TEST(ViewPropertiesTest, SurfacesAreDrawnOnlyForTexelDensity)
{
  WindowSettings settings = default_settings();
  EXPECT_FALSE(engine_settings(settings).has_surfaces);
  const std::vector<std::string> on = {"on"};
  EXPECT_TRUE(set_property(settings, "density", std::span(on)));
  EXPECT_TRUE(engine_settings(settings).has_surfaces);
}

TEST(ViewPropertiesTest, WordsSetAPropertyAndWrongOnesAreNamed)
{
  scene::Lamp lamp;
  const auto set = [&](const std::string &name, const std::vector<std::string> &words) {
    return set_property(lamp, name, std::span(words));
  };
  EXPECT_TRUE(set("kind", {"spot"}));
  EXPECT_TRUE(set("cone", {"90"}));
  EXPECT_FLOAT_EQ(lamp.spot_outer_angle, glm::radians(45.0F));
  EXPECT_TRUE(set("color", {"1", "0.5", "0"}));
  EXPECT_EQ(lamp.color, glm::vec3(1, 0.5F, 0));
  EXPECT_FALSE(set("angle", {"1"})) << "of a sun";
  EXPECT_FALSE(set("sweetness", {"1"}));
  const scene::Lamp before = lamp;
  for (const auto &[name, words] :
       std::vector<std::pair<std::string, std::vector<std::string>>>{{"power", {"-1"}},
                                                                     {"power", {"nan"}},
                                                                     {"power", {"1", "2"}},
                                                                     {"color", {"1", "-2", "0"}},
                                                                     {"kind", {"torch"}},
                                                                     {"kind", {}}}) {
    EXPECT_THROW(set(name, words), std::runtime_error) << name;
  }
  EXPECT_EQ(lamp, before);
}

TEST(PropertyLimits, AreNotInvertedByOtherValues)
{
  const auto check = [](const auto &thing) {
    for (const auto &number : properties<std::decay_t<decltype(thing)>>().numbers) {
      const Limits limits = number.limits(thing);
      EXPECT_LE(limits.min, limits.max) << number.name;
    }
  };
  for (const float distance : {1e-12F, 1e12F}) {
    check(scene::Camera{.near = distance, .far = distance});
    ShadowOfLamp of;
    of.shadow.clip_start = distance;
    check(of);
    of.shadow = {};
    of.shadow.clip_end = distance;
    check(of);
  }
}

TEST(ViewPropertiesTest, AShadowHasTheSettingsThatHaveAnEffectForItsKindAndEachMayBeAsTheScene)
{
  const std::vector<std::string> depths = {"shadow_size", "bias", "clip_start", "clip_end"};
  const std::vector<std::string> exponential = {"exponent", "filter_radius", "esm_size"};
  const auto applying = [](const ShadowOfLamp &of) {
    std::set<std::string> names;
    for (const auto &property : properties<ShadowOfLamp>().choices) {
      if (property.applies(of)) {
        names.insert(property.name);
      }
    }
    for (const auto &property : properties<ShadowOfLamp>().numbers) {
      if (property.applies(of)) {
        names.insert(property.name);
      }
    }
    return names;
  };
  using enum scene::ShadowKind;
  ShadowOfLamp of{scene::LampKind::Point, Pcf};
  std::set<std::string> expected(depths.begin(), depths.end());
  expected.insert("shadow");
  EXPECT_EQ(applying(of), expected);
  of.shadow.kind = Evsm;
  expected.insert(exponential.begin(), exponential.end());
  EXPECT_EQ(applying(of), expected);
  of.shadow.kind = std::nullopt;
  of.scene_kind = Esm;
  expected.insert("esm_format");
  EXPECT_EQ(applying(of), expected);
  // Suns have no exponential shadows, and no distances.
  of.lamp = scene::LampKind::Sun;
  EXPECT_EQ(applying(of), (std::set<std::string>{"shadow", "shadow_size", "bias"}));
  of.shadow.kind = None;
  EXPECT_EQ(applying(of), std::set<std::string>{"shadow"});
  of = {scene::LampKind::Point, None, {.kind = Hard}};
  EXPECT_EQ(applying(of), std::set<std::string>{"shadow"}) << "the scene has none";
  of.lamp = scene::LampKind::Hemi;
  EXPECT_TRUE(applying(of).empty());

  of = {scene::LampKind::Spot, Esm};
  const auto set = [&](const std::string &name, const std::string &word) {
    return set_property(of, name, std::span(&word, 1));
  };
  EXPECT_TRUE(set("shadow_size", "300"));
  EXPECT_EQ(of.shadow.size, 300);
  EXPECT_TRUE(set("filter_radius", "9"));
  EXPECT_FLOAT_EQ(*of.shadow.filter_angle, glm::radians(9.0F));
  EXPECT_TRUE(set("esm_format", "32f"));
  EXPECT_EQ(of.shadow.esm_format, scene::EsmFormat::Float);
  EXPECT_TRUE(set("clip_start", "2"));
  EXPECT_THROW(set("clip_end", "2"), std::runtime_error);
  EXPECT_TRUE(set("clip_end", "2.5"));
  EXPECT_THROW(set("clip_start", "2.5"), std::runtime_error);
  EXPECT_TRUE(set("clip_start", "as the scene"));
  EXPECT_FALSE(of.shadow.clip_start);
  EXPECT_TRUE(set("clip_end", "0.001"));
  for (const char *name : {"shadow", "shadow_size", "filter_radius", "esm_format", "clip_end"}) {
    EXPECT_TRUE(set(name, "as the scene"));
  }
  EXPECT_EQ(of.shadow, scene::LampShadow());
}

TEST(ViewPropertiesTest, EveryFactorOfAMaterialIsAPropertyOfItsOwn)
{
  scene::Material material;
  const std::vector<std::pair<std::string, std::vector<std::string>>> values = {
      {"specular_color", {"2", "1", "0.5"}},
      {"coat", {"0.25"}},
      {"coat_roughness", {"0.5"}},
      {"sheen_color", {"0.1", "0.2", "0.3"}},
      {"sheen_roughness", {"0.7"}},
      {"anisotropy", {"0.8"}},
      {"anisotropy_rotation", {"90"}},
      {"transmission", {"0.9"}},
      {"thickness", {"3"}},
      {"ior", {"1.33"}},
      {"attenuation_distance", {"4"}},
      {"attenuation_color", {"0.4", "0.5", "0.6"}}};
  for (const auto &[name, words] : values) {
    EXPECT_TRUE(set_property(material, name, std::span(words))) << name;
  }
  EXPECT_EQ(material.specular_color, glm::vec3(2.0F, 1.0F, 0.5F));
  EXPECT_EQ(material.coat, 0.25F);
  EXPECT_EQ(material.coat_roughness, 0.5F);
  EXPECT_EQ(material.sheen_color, glm::vec3(0.1F, 0.2F, 0.3F));
  EXPECT_EQ(material.sheen_roughness, 0.7F);
  EXPECT_EQ(material.anisotropy, 0.8F);
  EXPECT_FLOAT_EQ(material.anisotropy_rotation, glm::radians(90.0F));
  EXPECT_EQ(material.transmission, 0.9F);
  EXPECT_EQ(material.thickness, 3.0F);
  EXPECT_EQ(material.ior, 1.33F);
  EXPECT_EQ(material.attenuation_distance, 4.0F);
  EXPECT_EQ(material.attenuation_color, glm::vec3(0.4F, 0.5F, 0.6F));
  const std::vector<std::string> none = {"no absorption"};
  EXPECT_TRUE(set_property(material, "attenuation_distance", std::span(none)));
  EXPECT_EQ(material.attenuation_distance, 0.0F);
  // Occlusion is in a texture.
  const std::vector<std::string> half = {"0.5"};
  EXPECT_FALSE(set_property(material, "occlusion_strength", std::span(half)));
  scene::Scene scene;
  const auto image =
      scene.add(scene::Image{.name = "cracks", .width = 1, .height = 2, .texels = std::vector<std::uint8_t>(8)});
  const auto unnamed = scene.add(scene::Image{.width = 1, .height = 1, .texels = std::vector<std::uint8_t>(4)});
  const auto removed = scene.add(scene::Texture{.image = unnamed});
  material.occlusion_texture = scene.add(scene::Texture{.image = image});
  material.coat_normal_texture = scene.add(scene::Texture{.image = unnamed});
  material.emissive_texture = removed;
  scene.remove(removed);
  EXPECT_TRUE(set_property(material, "occlusion_strength", std::span(half)));
  EXPECT_EQ(material.occlusion_strength, 0.5F);
  EXPECT_EQ(texture_lines(scene, material),
            (std::vector<TextureLine>{{"Occlusion", "cracks, 1x2"}, {"Coat normal", "1x1"}}));
}

// The two parts, which have rows of their own.
static_assert(test::member_count<WindowSettings>() == test::row_count<WindowSettings>() + 2);

/** Checks that the window shows each row of \a Part with a label, within the same limits. */
template <typename Part, typename T>
void expect_rows(double factor_of_cone = 1.0)
{
  const Properties<T> &shown = properties<T>();
  Part::for_each_property([&](const auto &row) {
    if (row.label.empty()) {
      return;
    }
    const auto is_it = [&](const auto &property) { return property.name == row.key_or_name(); };
    const auto number = std::ranges::find_if(shown.numbers, is_it);
    const bool is_choice = std::ranges::any_of(shown.choices, is_it);
    EXPECT_TRUE(is_choice || number != shown.numbers.end()) << row.name;
    if (number != shown.numbers.end()) {
      const scene::ShownUnit unit = scene::shown_unit(row);
      const double factor = row.name == "spot_outer_angle" ? factor_of_cone : 1.0;
      EXPECT_NEAR(number->max, factor * unit.factor * row.max, 1e-9 * number->max) << row.name;
      const bool is_rounded = row.unit == "bytes" || number->is_zero_absent;
      EXPECT_TRUE(is_rounded || number->min == factor * unit.factor * row.min) << row.name;
      EXPECT_EQ(number->label, row.label);
      EXPECT_TRUE(row.name == "intensity" || number->unit(T()) == unit.text) << row.name;
    }
  });
}

TEST(ViewPropertiesTest, TheWindowShowsEachRowOfThingsAndSettingsWithinItsLimits)
{
  expect_rows<scene::Lamp, scene::Lamp>(2.0);
  expect_rows<scene::LampShadow, ShadowOfLamp>();
  expect_rows<scene::Camera, scene::Camera>();
  expect_rows<scene::Material, scene::Material>();
  expect_rows<scene::Node, scene::Node>();
  expect_rows<scene::World, scene::World>();
  expect_rows<WindowSettings, WindowSettings>();
  expect_rows<eevee::Settings, WindowSettings>();
  expect_rows<eevee::ShadowSettings, WindowSettings>();
  expect_rows<render_scene::Display, WindowSettings>();
}

TEST(ViewPropertiesTest, ShadowSettingsOfAllLampsAreThoseOfTheCommandLine)
{
  WindowSettings settings;
  const eevee::ShadowSettings &shadow = settings.eevee.shadow;
  const auto set = [&](const std::string &name, const std::string &word) {
    return set_property(settings, name, std::span(&word, 1));
  };
  EXPECT_FALSE(set("pcf_lookups", "9")) << "of a square kernel";
  EXPECT_TRUE(set("pcf", "5x5"));
  EXPECT_EQ(shadow.pcf.width, 5);
  EXPECT_TRUE(set("pcf", "disk"));
  EXPECT_TRUE(set("pcf_lookups", "9"));
  EXPECT_EQ(shadow.pcf, (eevee::PcfKernel{0, 9}));
  EXPECT_TRUE(set("esm", "separable"));
  EXPECT_EQ(shadow.esm.kernel, eevee::EsmKernel::Separable);
  EXPECT_TRUE(set("esm_size", "64"));
  EXPECT_EQ(shadow.esm.size_px, 64);
  EXPECT_TRUE(set("exponent", "20"));
  EXPECT_EQ(shadow.esm.exponent, 20.0F);
  EXPECT_TRUE(set("filter_radius", "2"));
  EXPECT_FLOAT_EQ(*shadow.esm.filter_angle, glm::radians(2.0F));
  EXPECT_TRUE(set("exponent", "automatic"));
  EXPECT_TRUE(set("filter_radius", "automatic"));
  EXPECT_FALSE(shadow.esm.exponent || shadow.esm.filter_angle);
  EXPECT_TRUE(set("cascade_count", "3"));
  EXPECT_EQ(shadow.cascades.count, 3);
  EXPECT_TRUE(set("cascade_lambda", "0.5"));
  EXPECT_EQ(shadow.cascades.lambda, 0.5F);
  EXPECT_TRUE(set("cascade_range", "depth"));
  EXPECT_TRUE(shadow.is_fitted_to_depth);
  EXPECT_TRUE(set("casters", "back"));
  EXPECT_EQ(shadow.caster_faces, eevee::CasterFaces::Back);
  EXPECT_TRUE(set("shadow_memory", "64"));
  EXPECT_EQ(shadow.memory_bytes_max, std::size_t(64) << 20U);
}

TEST(ViewPropertiesTest, ACameraHasTheNumbersOfItsKindAndItsFarDistanceStaysBeyondTheNearOne)
{
  scene::Camera camera;
  const auto set = [&](const std::string &name, const std::string &word) {
    return set_property(camera, name, std::span(&word, 1));
  };
  EXPECT_TRUE(set("vertical_angle", "90"));
  EXPECT_FLOAT_EQ(camera.vertical_angle, glm::radians(90.0F));
  EXPECT_TRUE(set("aspect", "2"));
  EXPECT_EQ(camera.aspect, 2.0F);
  EXPECT_TRUE(set("aspect", "as the picture"));
  EXPECT_EQ(camera.aspect, 0.0F);
  EXPECT_TRUE(set("near", "5"));
  EXPECT_THROW(set("near", "0"), std::runtime_error) << "in perspective";
  EXPECT_THROW(set("far", "5"), std::runtime_error);
  EXPECT_TRUE(set("far", "7"));
  EXPECT_THROW(set("near", "7"), std::runtime_error);
  EXPECT_TRUE(set("far", "infinite"));
  EXPECT_EQ(camera.far, 0.0F);
  EXPECT_FALSE(set("half_width", "3"));

  EXPECT_TRUE(set("kind", "orthographic"));
  EXPECT_GT(camera.far, camera.near) << "files of such cameras need one";
  EXPECT_THROW(set("far", "infinite"), std::runtime_error);
  EXPECT_TRUE(set("near", "0"));
  EXPECT_TRUE(set("far", "0.01"));
  EXPECT_TRUE(set("half_width", "3"));
  EXPECT_EQ(camera.half_width, 3.0F);
  EXPECT_FALSE(set("vertical_angle", "40"));
  EXPECT_TRUE(set("kind", "perspective"));
  EXPECT_TRUE(camera.near > 0.0F && camera.near < camera.far) << camera.near;
}

TEST(ViewScriptTest, WordsAreSeparatedBySpacesQuotesKeepThemAndCommentsEndALine)
{
  const std::vector<ScriptLine> lines = parse_script("open \"a file.glb\"  # first\n\n\t set  color 1 \"\" 3\r\n#none");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].number, 1);
  EXPECT_EQ(lines[0].words, (std::vector<std::string>{"open", "a file.glb"}));
  EXPECT_EQ(lines[1].number, 3);
  EXPECT_EQ(lines[1].words, (std::vector<std::string>{"set", "color", "1", "", "3"}));
  EXPECT_THROW(static_cast<void>(parse_script("open \"a")), std::runtime_error);
  EXPECT_EQ(parse_script("\xEF\xBB\xBFquit\n").at(0).words, std::vector<std::string>{"quit"});
}

TEST(ViewScriptTest, APipeIsRefused)
{
  const std::filesystem::path fifo = std::filesystem::temp_directory_path() / ("script" + std::to_string(getpid()));
  ASSERT_EQ(mkfifo(fifo.c_str(), 0666), 0);
  EXPECT_THROW(Script{fifo}, std::runtime_error);
  std::filesystem::remove(fifo);
}

}  // namespace
}  // namespace gnomon::view
