// SPDX-License-Identifier: MIT
#pragma once

#include "view_properties.hh"

#include <cmath>
#include <concepts>
#include <numbers>
#include <optional>
#include <utility>

/** Properties of members of a thing, for the tables. */
namespace gnomon::view {

inline constexpr double degrees_per_radian = 180.0 / std::numbers::pi;
/** A limit for lengths and powers that have none. */
inline constexpr double endless = 1e9;
/** What the engine takes of exponential shadows: eevee::EsmSettings. */
inline constexpr double esm_size_min = 4.0;
inline constexpr double esm_size_max = 8192.0;
inline constexpr double esm_filter_degrees_max = 28.6;

inline const std::vector<const char *> off_on = {"off", "on"};
inline const std::vector<const char *> shadow_kinds = {"none", "hard", "pcf", "esm", "evsm"};

/** A value as it is stored. */
template <typename Value>
Value stored(double value)
{
  if constexpr (std::integral<Value>) {
    return Value(std::llround(value));
  }
  else {
    return Value(value);
  }
}

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
      (thing.*member)[i] = stored<typename Value::value_type>(value / factor);
    };
  }
  else {
    property.get = [=](const T &thing, int) { return double(thing.*member) * factor; };
    property.set = [=](T &thing, int, double value) { thing.*member = stored<Value>(value / factor); };
  }
  return property;
}

template <typename T>
NumberProperty<T> color(const char *name, const char *label, glm::vec3 T::*member, double max = 1.0)
{
  NumberProperty<T> property = number<T>(name, label, "", member, 0.0, max);
  property.is_color = true;
  return property;
}

/** A length whose absence is stored as 0. \a first: where there was none */
template <typename T>
NumberProperty<T> zero_is(const char *absent, double first, NumberProperty<T> property)
{
  property.absent = absent;
  property.is_absent = [get = property.get](const T &thing) { return get(thing, 0) == 0.0; };
  property.remove = [set = property.set](T &thing) { set(thing, 0, 0.0); };
  property.get = [get = property.get, first](const T &thing, int i) {
    const double value = get(thing, i);
    return value == 0.0 ? first : value;
  };
  return property;
}

/** For kinds of things. */
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

}  // namespace gnomon::view
