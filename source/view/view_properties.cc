// SPDX-License-Identifier: MIT
#include "view_properties.hh"

#include "scene_units.hh"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glm/gtx/euler_angles.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace gnomon::view {

namespace {

constexpr double degree = 180.0 / 3.14159265358979323846;
constexpr double endless = 1e9;

const std::vector<const char *> off_on = {"off", "on"};
const std::vector<const char *> shadow_kinds = {"none", "hard", "pcf", "esm", "evsm"};

/** A number or three of \a T that is a member. \a factor: shown = stored * factor. */
template <typename T, typename Value>
NumberProperty<T> number(const char *name, const char *label, const char *unit, Value T::*member, double min,
                         double max, double factor = 1.0)
{
  NumberProperty<T> property{.name = name,
                             .label = label,
                             .unit = [unit](const T &) { return unit; },
                             .width = 1,
                             .min = min,
                             .max = max,
                             .get = {},
                             .set = {}};
  if constexpr (requires(Value value) { value.x; }) {
    property.width = 3;
    property.get = [=](const T &thing, int i) { return double((thing.*member)[i]) * factor; };
    property.set = [=](T &thing, int i, double value) {
      (thing.*member)[i] = typename Value::value_type(value / factor);
    };
  }
  else {
    property.get = [=](const T &thing, int) { return double(thing.*member) * factor; };
    property.set = [=](T &thing, int, double value) { thing.*member = Value(value / factor); };
  }
  return property;
}

template <typename T>
NumberProperty<T> color(const char *name, const char *label, glm::vec3 T::*member)
{
  NumberProperty<T> property = number<T>(name, label, "", member, 0.0, 1.0);
  property.is_color = true;
  return property;
}

/** For kinds of lamps. */
template <typename T, typename... Kinds>
NumberProperty<T> only(NumberProperty<T> property, Kinds... kinds)
{
  property.applies = [=](const T &thing) { return ((thing.kind == kinds) || ...); };
  return property;
}

/** An enumeration or a bool, whose values count from 0 as the options do. */
template <typename T, typename Value>
ChoiceProperty<T> choice(const char *name, const char *label, std::vector<const char *> options, Value T::*member)
{
  return {name,
          label,
          std::move(options),
          [=](const T &thing) { return int(thing.*member); },
          [=](T &thing, int value) { thing.*member = Value(value); },
          {}};
}

Properties<scene::Lamp> make_lamp_properties()
{
  using scene::Lamp;
  using enum scene::LampKind;
  Properties<Lamp> made;
  made.choices.push_back(choice("kind", "Kind", {"point", "sun", "spot", "hemi", "area"}, &Lamp::kind));
  ChoiceProperty<Lamp> shape = choice("area_shape", "Shape", {"rectangle", "ellipse"}, &Lamp::area_shape);
  shape.applies = [](const Lamp &lamp) { return lamp.kind == Area; };
  made.choices.push_back(std::move(shape));
  ChoiceProperty<Lamp> shadow{"shadow", "Shadow", {"as the scene"},
                              {},       {},       [](const Lamp &lamp) { return lamp.kind != Hemi; }};
  shadow.options.insert(shadow.options.end(), shadow_kinds.begin(), shadow_kinds.end());
  shadow.get = [](const Lamp &lamp) { return lamp.shadow.kind ? int(*lamp.shadow.kind) + 1 : 0; };
  shadow.set = [](Lamp &lamp, int value) {
    lamp.shadow.kind = value == 0 ? std::nullopt : std::optional(scene::ShadowKind(value - 1));
  };
  made.choices.push_back(std::move(shadow));

  made.numbers.push_back(color<Lamp>("color", "Color", &Lamp::color));
  NumberProperty<Lamp> power = number("power", "Power", "", &Lamp::intensity, 0.0, endless);
  power.unit = [](const Lamp &lamp) { return scene::intensity_unit(lamp.kind); };
  made.numbers.push_back(std::move(power));
  made.numbers.push_back(only(number("radius", "Radius", "m", &Lamp::radius, 0.0, 1000.0), Point, Spot));
  made.numbers.push_back(only(number("angle", "Angle", "°", &Lamp::angle, 0.0, 180.0, degree), Sun));
  made.numbers.push_back(only(number("cone", "Cone", "°", &Lamp::spot_outer_angle, 0.2, 180.0, 2.0 * degree), Spot));
  made.numbers.push_back(only(number("blend", "Blend", "", &Lamp::spot_blend, 0.0, 1.0), Spot));
  made.numbers.push_back(only(number("range", "Range", "m", &Lamp::range, 0.0, endless), Point, Spot));
  made.numbers.push_back(only(number("size_x", "Size X", "m", &Lamp::area_size_x, 1e-3, 1e4), Area));
  made.numbers.push_back(only(number("size_y", "Size Y", "m", &Lamp::area_size_y, 1e-3, 1e4), Area));
  return made;
}

Properties<scene::Material> make_material_properties()
{
  using scene::Material;
  Properties<Material> made;
  made.choices.push_back(choice("double_sided", "Double-sided", off_on, &Material::is_double_sided));
  made.choices.push_back(choice("unlit", "Unlit", off_on, &Material::is_unlit));
  made.choices.push_back(choice("alpha_mode", "Alpha mode", {"opaque", "mask", "blend"}, &Material::alpha_mode));
  made.numbers.push_back(color<Material>("base_color", "Base color", &Material::base_color));
  made.numbers.push_back(number("alpha", "Alpha", "", &Material::alpha, 0.0, 1.0));
  NumberProperty<Material> cutoff = number("alpha_cutoff", "Cutoff", "", &Material::alpha_cutoff, 0.0, 1.0);
  cutoff.applies = [](const Material &material) { return material.alpha_mode == scene::AlphaMode::Mask; };
  made.numbers.push_back(std::move(cutoff));
  made.numbers.push_back(number("metallic", "Metallic", "", &Material::metallic, 0.0, 1.0));
  made.numbers.push_back(number("roughness", "Roughness", "", &Material::roughness, 0.0, 1.0));
  made.numbers.push_back(number("specular", "Specular", "", &Material::specular, 0.0, 1.0));
  made.numbers.push_back(number("emissive", "Emission", "W/(sr m²)", &Material::emissive, 0.0, 1e6));
  made.numbers.push_back(number("normal_scale", "Normal scale", "", &Material::normal_scale, -10.0, 10.0));
  return made;
}

Properties<Settings> make_settings_properties()
{
  Properties<Settings> made;
  const auto shadow_of = [](auto &settings) -> auto &
  {
    return settings.eevee.shadow;
  };
  made.choices.push_back({"shadow",
                          "Shadows",
                          shadow_kinds,
                          [=](const Settings &settings) { return int(shadow_of(settings).kind); },
                          [=](Settings &settings, int value) { shadow_of(settings).kind = scene::ShadowKind(value); },
                          {}});
  made.choices.push_back({"background",
                          "Background",
                          {"grey", "world"},
                          [](const Settings &settings) {
                            return settings.eevee.background.kind == eevee::Background::Kind::World ? 1 : 0;
                          },
                          [](Settings &settings, int value) {
                            settings.eevee.background.kind =
                                value == 1 ? eevee::Background::Kind::World : eevee::Background::Kind::None;
                          },
                          {}});
  made.choices.push_back(
      choice("transform", "View transform", {"standard", "raw", "agx", "pbr-neutral"}, &Settings::view_transform));
  made.choices.push_back({"specular",
                          "Specular",
                          {"single", "multi"},
                          [](const Settings &settings) { return int(settings.eevee.has_multiscatter); },
                          [](Settings &settings, int value) { settings.eevee.has_multiscatter = value == 1; },
                          {}});
  made.choices.push_back({"cascades",
                          "Show cascades",
                          off_on,
                          [](const Settings &settings) { return int(settings.eevee.has_cascade_tint); },
                          [](Settings &settings, int value) { settings.eevee.has_cascade_tint = value == 1; },
                          {}});
  made.choices.push_back(choice("density", "Show texel density", off_on, &Settings::has_texel_density));
  made.choices.push_back({"times",
                          "Measure times",
                          off_on,
                          [](const Settings &settings) { return int(settings.eevee.is_timed); },
                          [](Settings &settings, int value) { settings.eevee.is_timed = value == 1; },
                          {}});
  made.numbers.push_back({"samples", "Samples", [](const Settings &) { return "per pixel"; }, 1, 1.0, 65536.0,
                          [](const Settings &settings, int) { return double(settings.eevee.sample_count); },
                          [](Settings &settings, int, double value) { settings.eevee.sample_count = int(value); }});
  made.numbers.push_back(
      {"noise", "Noise threshold", [](const Settings &) { return ""; }, 1, 0.0, 1.0,
       [](const Settings &settings, int) { return double(settings.eevee.noise_threshold); },
       [](Settings &settings, int, double value) { settings.eevee.noise_threshold = float(value); }});
  made.numbers.push_back({"shadow_size", "Shadow size", [](const Settings &) { return "px"; }, 1, 16.0, 8192.0,
                          [=](const Settings &settings, int) { return double(shadow_of(settings).map_size_px); },
                          [=](Settings &settings, int, double value) {
                            shadow_of(settings).map_size_px = int(value);
                            shadow_of(settings).cube_size_px = std::max(1, int(value) / 2);
                          }});
  made.numbers.push_back(number("error", "Maximum error", "RMSE", &Settings::error_max, 0.0, 1.0));
  made.numbers.push_back(number("seconds", "Time limit", "s", &Settings::seconds_max, 0.0, 3600.0));
  made.numbers.push_back(number("budget", "Time budget", "ms a frame", &Settings::budget_ms, 0.0, 1000.0));
  made.numbers.push_back(number("exposure", "Exposure", "stops", &Settings::exposure, -20.0, 20.0));
  return made;
}

}  // namespace

template <>
const Properties<scene::Lamp> &properties()
{
  static const Properties<scene::Lamp> made = make_lamp_properties();
  return made;
}

template <>
const Properties<scene::Material> &properties()
{
  static const Properties<scene::Material> made = make_material_properties();
  return made;
}

template <>
const Properties<Settings> &properties()
{
  static const Properties<Settings> made = make_settings_properties();
  return made;
}

template <>
const Properties<Placement> &properties()
{
  static const Properties<Placement> made = {
      {},
      {number("position", "Position", "m", &Placement::position, -endless, endless),
       number("rotation", "Rotation", "°", &Placement::rotation, -360.0, 360.0),
       number("scale", "Scale", "", &Placement::scale, -1e6, 1e6)}};
  return made;
}

template <>
const Properties<scene::Node> &properties()
{
  static const Properties<scene::Node> made = {
      {choice("visible", "Visible", off_on, &scene::Node::is_visible),
       choice("casts_shadow", "Casts shadow", off_on, &scene::Node::casts_shadow),
       choice("receives_shadow", "Receives shadow", off_on, &scene::Node::receives_shadow)},
      {}};
  return made;
}

template <>
const Properties<scene::World> &properties()
{
  static const Properties<scene::World> made = {
      {},
      {color<scene::World>("color", "Color", &scene::World::color),
       number("strength", "Strength", "", &scene::World::strength, 0.0, 1e6),
       number("rotation", "Rotation", "°", &scene::World::rotation, -360.0, 360.0, degree)}};
  return made;
}

Placement placement_of(const glm::dmat4 &parent_from_node)
{
  glm::dmat3 axes(parent_from_node);
  Placement placement{.position = glm::dvec3(parent_from_node[3]), .scale = scene::scale_of(parent_from_node)};
  if (glm::determinant(axes) < 0.0) {
    placement.scale.x = -placement.scale.x;
    axes[0] = -axes[0];
  }
  glm::dmat4 frame(1.0);
  if (glm::determinant(axes) > 0.0) {
    // The x and y axes are kept as far as the matrix has no shear.
    frame[0] = glm::dvec4(glm::normalize(axes[0]), 0.0);
    const glm::dvec3 z = glm::normalize(glm::cross(axes[0], axes[1]));
    frame[2] = glm::dvec4(z, 0.0);
    frame[1] = glm::dvec4(glm::cross(z, glm::dvec3(frame[0])), 0.0);
  }
  glm::extractEulerAngleZYX(frame, placement.rotation.z, placement.rotation.y, placement.rotation.x);
  placement.rotation *= degree;
  return placement;
}

glm::dmat4 placed(const glm::dmat4 &parent_from_node, const Placement &placement)
{
  const Placement before = placement_of(parent_from_node);
  glm::dmat4 moved = parent_from_node;
  if (placement.rotation != before.rotation || placement.scale != before.scale) {
    const glm::dvec3 angles = placement.rotation / degree;
    moved = glm::eulerAngleZYX(angles.z, angles.y, angles.x);
    for (int axis = 0; axis < 3; axis++) {
      moved[axis] *= placement.scale[axis];
    }
  }
  moved[3] = glm::dvec4(placement.position, 1.0);
  return moved;
}

namespace {

double parse_number(const std::string &name, const std::string &word, double min, double max)
{
  double value = 0.0;
  const char *end = word.data() + word.size();
  const auto [after, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc() || after != end || !(value >= min && value <= max)) {
    throw std::runtime_error(fmt::format("{}: '{}' is not a number from {} to {}", name, word, min, max));
  }
  return value;
}

}  // namespace

template <typename T>
bool set_property(T &thing, const std::string &name, std::span<const std::string> words)
{
  const auto is_it = [&](const auto &property) {
    return name == property.name && (!property.applies || property.applies(thing));
  };
  const Properties<T> &all = properties<T>();
  if (const auto number = std::ranges::find_if(all.numbers, is_it); number != all.numbers.end()) {
    if (words.size() != std::size_t(number->width)) {
      throw std::runtime_error(fmt::format("{}: takes {} numbers, not {}", name, number->width, words.size()));
    }
    T changed = thing;
    for (int i = 0; i < number->width; i++) {
      number->set(changed, i, parse_number(name, words[std::size_t(i)], number->min, number->max));
    }
    thing = std::move(changed);
    return true;
  }
  const auto choice = std::ranges::find_if(all.choices, is_it);
  if (choice == all.choices.end()) {
    return false;
  }
  const auto option = std::ranges::find(choice->options, words.size() == 1 ? words[0] : std::string(),
                                        [](const char *text) { return std::string(text); });
  if (option == choice->options.end()) {
    throw std::runtime_error(fmt::format("{}: is one of {}", name, fmt::join(choice->options, ", ")));
  }
  choice->set(thing, int(option - choice->options.begin()));
  return true;
}

template bool set_property(Placement &, const std::string &, std::span<const std::string>);
template bool set_property(scene::Node &, const std::string &, std::span<const std::string>);
template bool set_property(scene::Lamp &, const std::string &, std::span<const std::string>);
template bool set_property(scene::Material &, const std::string &, std::span<const std::string>);
template bool set_property(scene::World &, const std::string &, std::span<const std::string>);
template bool set_property(Settings &, const std::string &, std::span<const std::string>);

}  // namespace gnomon::view
