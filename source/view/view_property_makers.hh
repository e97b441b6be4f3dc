// SPDX-License-Identifier: MIT
#pragma once

#include "view_properties.hh"

#include "scene_property.hh"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>

/** Properties for the tables, from rows (scene_property.hh). */
namespace gnomon::view {

inline constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

/** Convert a number to the stored type. */
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

/** A number or three of \a T. \a access: returns a reference to the value */
template <typename T, typename Access>
NumberProperty<T> number_property(const scene::Description &row, Access access)
{
  using Value = std::decay_t<std::invoke_result_t<Access, T &>>;
  const scene::ShownUnit unit = scene::shown_unit(row);
  const scene::ShownLimits limits = scene::shown_limits(row, std::integral<Value>);
  NumberProperty<T> property{.name = row.key_or_name().data(),
                             .label = row.label.data(),
                             .unit = [text = unit.text](const T &) { return text.empty() ? "" : text.data(); },
                             .width = 1,
                             .min = limits.min,
                             .max = limits.max,
                             .get = {},
                             .set = {}};
  property.group = row.group.empty() ? "" : row.group.data();
  if constexpr (requires(Value value) { value.x; }) {
    property.width = 3;
    // Values with three components and a unit are radiance; without a unit they are colours.
    property.is_color = row.unit.empty();
    property.get = [=](const T &thing, int i) { return double(access(thing)[i]) * unit.factor; };
    property.set = [=](T &thing, int i, double value) {
      access(thing)[i] = stored<typename Value::value_type>(value / unit.factor);
    };
  }
  else {
    property.get = [=](const T &thing, int) { return double(access(thing)) * unit.factor; };
    property.set = [=](T &thing, int, double value) { access(thing) = stored<Value>(value / unit.factor); };
  }
  return property;
}

/** A number that may be absent. Absence is shown as \a absent; the initial value is the row's `first`. */
template <typename T, typename Access>
NumberProperty<T> optional_number(const scene::Description &row, Access access, const char *absent)
{
  const auto present = [=](auto &thing) -> auto &
  {
    return *access(thing);
  };
  NumberProperty<T> property = number_property<T>(row, present);
  property.absent = absent;
  property.is_absent = [=](const T &thing) { return !access(thing); };
  property.remove = [=](T &thing) { access(thing).reset(); };
  property.get = [=, get = property.get](const T &thing, int i) {
    return access(thing) ? get(thing, i) : row.first * scene::shown_unit(row).factor;
  };
  property.set = [=, set = property.set](T &thing, int i, double value) {
    access(thing).emplace();
    set(thing, i, value);
  };
  return property;
}

/** A number whose absence is stored as 0, as the row says. */
template <typename T>
NumberProperty<T> zero_is_absent(const scene::Description &row, NumberProperty<T> property)
{
  property.absent = row.zero.data();
  property.is_zero_absent = true;
  property.is_absent = [get = property.get](const T &thing) { return get(thing, 0) == 0.0; };
  property.remove = [set = property.set](T &thing) { set(thing, 0, 0.0); };
  property.get = [get = property.get, first = row.first * scene::shown_unit(row).factor](const T &thing, int i) {
    const double value = get(thing, i);
    return value == 0.0 ? first : value;
  };
  // 0 means absence, so the smallest value is the row's `first`.
  property.min = property.min == 0.0 ? row.first : property.min;
  return property;
}

/** Options from \a words, after \a absent for no value if it is given. */
inline std::vector<const char *> options_of(const auto &words, const char *absent = nullptr)
{
  std::vector<const char *> options;
  if (absent) {
    options.push_back(absent);
  }
  std::ranges::transform(words, std::back_inserter(options), [](std::string_view word) { return word.data(); });
  return options;
}

/** An enumeration, a switch, or an enumeration that may be absent. */
template <typename T, typename Access>
ChoiceProperty<T> choice_property(const scene::Description &row, Access access, const char *absent)
{
  using Value = std::decay_t<std::invoke_result_t<Access, T &>>;
  ChoiceProperty<T> property{
      .name = row.key_or_name().data(), .label = row.label.data(), .options = {}, .get = {}, .set = {}};
  property.group = row.group.empty() ? "" : row.group.data();
  if constexpr (requires(Value value) { value.has_value(); }) {
    using Inner = typename Value::value_type;
    property.options = options_of(scene::words<Inner>, absent);
    property.get = [=](const T &thing) { return access(thing) ? int(*access(thing)) + 1 : 0; };
    property.set = [=](T &thing, int value) { access(thing) = value == 0 ? Value() : Value(Inner(value - 1)); };
  }
  else {
    if constexpr (std::is_same_v<Value, bool>) {
      property.options = options_of(row.switch_words);
    }
    else {
      property.options = options_of(scene::words<Value>);
    }
    property.get = [=](const T &thing) { return int(access(thing)); };
    property.set = [=](T &thing, int value) { access(thing) = Value(value); };
  }
  return property;
}

/**
 * Add properties for the rows of \a Part that have a label and hold numbers or choices. \a part: returns a reference to
 * the part of a T. \a absent: text for an absent value.
 */
template <typename Part, typename T, typename PartAccess>
void add_rows(Properties<T> &made, PartAccess part, const char *absent = nullptr)
{
  Part::for_each_property([&](const auto &row) {
    if (row.label.empty()) {
      return;
    }
    using Value = typename std::decay_t<decltype(row)>::Value;
    const auto access = [ part, row ](auto &thing) -> auto &
    {
      return row.access(part(thing));
    };
    const auto set_kinds = [&](auto &property) {
      if constexpr (requires(T thing) { thing.kind; }) {
        if (row.kinds != 0) {
          property.applies = [kinds = scene::Description(row)](const T &thing) {
            return kinds.has_kind(unsigned(thing.kind));
          };
        }
      }
    };
    const auto add_number = [&](NumberProperty<T> property) {
      set_kinds(property);
      made.numbers.push_back(std::move(property));
    };
    const auto add_choice = [&](ChoiceProperty<T> property) {
      set_kinds(property);
      made.choices.push_back(std::move(property));
    };
    if constexpr (std::is_enum_v<Value> || std::is_same_v<Value, bool>) {
      add_choice(choice_property<T>(row, access, nullptr));
    }
    else if constexpr (requires(Value value) { value.has_value(); }) {
      if constexpr (std::is_enum_v<typename Value::value_type>) {
        add_choice(choice_property<T>(row, access, absent));
      }
      else {
        add_number(optional_number<T>(row, access, absent));
      }
    }
    else if constexpr (std::is_arithmetic_v<Value> || requires(Value value) { value.x; }) {
      NumberProperty<T> property = number_property<T>(row, access);
      add_number(row.zero.empty() ? std::move(property) : zero_is_absent(row, std::move(property)));
    }
  });
}

/** The property \a name, for changes that its row does not describe. */
template <typename Property>
Property &named(std::vector<Property> &properties, std::string_view name)
{
  const auto found =
      std::ranges::find(properties, name, [](const Property &one) { return std::string_view(one.name); });
  if (found == properties.end()) {
    throw std::logic_error("no property " + std::string(name));
  }
  return *found;
}

}  // namespace gnomon::view
