// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

/**
 * The type of a row. A row describes one property of a thing (scene_properties.hh) or one setting of an engine, an
 * import or a picture, and stands beside the type that has the member. Checks, files, options, Python, the window and
 * the documentation read the rows, so that each property and setting is described once.
 */
namespace gnomon::scene {

/** The type of a property's value, without std::optional. */
template <typename Value>
struct PresentValue {
  using Type = Value;
};
template <typename Value>
struct PresentValue<std::optional<Value>> {
  using Type = Value;
};

inline constexpr double float_max = std::numeric_limits<float>::max();

/**
 * Greatest absolute value of a number, if its row has no limit of its own. Products of a few such numbers, such as
 * areas and volumes, are finite in float.
 */
inline constexpr double number_max = 1e12;
/** Greatest intensity, radiance and strength of light. A hundred million of them are finite in float. */
inline constexpr double light_max = 1e30;

/** A mask in which bit n is set for each of \a values of an enumeration, where n is its number. */
template <typename... Values>
[[nodiscard]] constexpr unsigned bits(Values... values)
{
  return ((1U << unsigned(values)) | ...);
}

/** The meaning of a property and the values that it may have. */
struct Description {
  /** The member's name, in messages and in Python. */
  std::string_view name;
  /** Name in scripts of the window and, after a prefix, in extras of files. Empty: `name`. */
  std::string_view key{};
  /** Name of the option on the command line, after two dashes. It sets all rows with this option. Empty: no option. */
  std::string_view option{};
  /** Word of the option for a value that is chosen automatically. Empty: no such word. */
  std::string_view automatic{};
  /** Label in the window. Empty: the window has no row for the property. */
  std::string_view label{};
  /** Header above the row in the window. Empty: no header. */
  std::string_view group{};
  /** Unit of the value. Options and the window show degrees for "rad" and MiB for "bytes". \see shown_unit */
  std::string_view unit{};
  /** The words for false and true, in options, scripts and the window. */
  std::array<std::string_view, 2> switch_words{"off", "on"};
  /** Limits of a number, and of each component of a vector. */
  double min = 0.0;
  double max = number_max;
  /** Least absolute value of a number that may be negative. 0: no such limit. */
  double least = 0.0;
  /** Meaning of the value 0, which is then allowed beside the limits. Empty: 0 has no special meaning. */
  std::string_view zero{};
  /** First value in the window of a number that was absent, or 0 with the meaning `zero`. */
  double first = 0.0;
  /** Mask of the kinds of lamps or cameras that have the property. 0: all kinds. \see kind_of */
  unsigned kinds = 0;
  /** Mask of the kinds for which files have the property as an extra. 0: no extra. */
  unsigned extra_kinds = 0;
  /** Whether the extra is in degrees. The member is in radians. */
  bool is_extra_in_degrees = false;
  /** Path of the property in glTF, from its material, camera or lamp. Empty: glTF has no such property. */
  std::string_view path{};
  /** Whether KHR_animation_pointer can animate `path`. */
  bool is_animated = false;
  /** Aspect of the thing, as a number, whose revision an edit of the property raises. */
  unsigned aspect = 0;
  /** Whether pictures depend on the setting: parts of one picture must then have the same value. */
  bool makes_picture = true;
  /** Meaning of the property, for help, documentation and Python. */
  std::string_view sentence{};

  [[nodiscard]] constexpr std::string_view key_or_name() const
  {
    return key.empty() ? name : key;
  }
  /** Whether things of the kind with this number have the property. */
  [[nodiscard]] constexpr bool has_kind(unsigned kind) const
  {
    return kinds == 0 || (kinds >> kind & 1U) != 0;
  }
  /** Whether things of the kind with this number have the property as an extra in files. */
  [[nodiscard]] constexpr bool has_extra(unsigned kind) const
  {
    return (extra_kinds >> kind & 1U) != 0;
  }
  /** Whether \a value is within the limits when it is stored as a float. false: NaN. */
  [[nodiscard]] constexpr bool allows(double value) const
  {
    if (value == 0.0 && !zero.empty()) {
      return true;
    }
    if (!(value >= -float_max && value <= float_max)) {
      return false;
    }
    // A number below 0 may be stored as -0.
    return float(value) >= float(min) && float(value) <= float(max) && (value >= 0.0 || min < 0.0) &&
           float(value < 0.0 ? -value : value) >= float(least);
  }
  /** The allowed value next to \a value, which is not NaN. */
  [[nodiscard]] constexpr float nearest(double value) const
  {
    if (allows(value)) {
      return float(value);
    }
    if (value >= min && value <= max && least > 0.0) {
      return float(value < 0.0 ? -least : least);
    }
    return value < min && !zero.empty() ? 0.0F : float(value < min ? min : max);
  }
};

/** A unit that people read and write, and how many of it one unit of a value is. */
struct ShownUnit {
  std::string_view text{};
  double factor = 1.0;
};

/** Degrees for radians and MiB for bytes; other units as they are. */
[[nodiscard]] constexpr ShownUnit shown_unit(const Description &description)
{
  if (description.unit == "rad") {
    return {"°", 180.0 / std::numbers::pi};
  }
  if (description.unit == "bytes") {
    return {"MiB", 0x1p-20};
  }
  return {description.unit};
}

/** The least and the greatest number that people may write, in the shown unit. */
struct ShownLimits {
  double min = 0.0;
  double max = 0.0;
};

/** \a is_whole: fractions cannot be written, so that the limits are whole numbers. */
[[nodiscard]] ShownLimits shown_limits(const Description &description, bool is_whole);

/**
 * The limits as text: "from 0 to 1", "from 1 to 10, or the negative of such a number". \a factor: units of the text in
 * one unit of the value.
 */
[[nodiscard]] std::string range_text(const Description &description, double factor = 1.0);
/** Message for a \a value out of the limits, with the name, the value and the limits. */
[[nodiscard]] std::string range_fault(const Description &description, double value);

/** \a value in the shown unit, as options take it. */
[[nodiscard]] std::string number_text(const Description &description, double value);

/** Words for the values of an enumeration in files, options and scripts, indexed by the value. */
template <typename Enum>
inline constexpr std::array<std::string_view, 0> words{};

/** \a value of the property \a row, as an option takes it. Classes without a branch here have a text_of(). */
template <typename Value>
[[nodiscard]] std::string value_text(const Description &row, const Value &value)
{
  if constexpr (std::is_enum_v<Value>) {
    return std::string(words<Value>[std::size_t(value)]);
  }
  else if constexpr (std::is_same_v<Value, bool>) {
    return std::string(row.switch_words[std::size_t(value)]);
  }
  else if constexpr (std::is_same_v<Value, std::string>) {
    return value;
  }
  else if constexpr (requires { text_of(value); }) {
    return text_of(value);
  }
  else {
    return number_text(row, double(value));
  }
}

/** Calls \a visit with each number of \a value as a double. Enumerations, bools, texts and absent values have none. */
template <typename Value, typename Visit>
constexpr void for_each_number(const Value &value, Visit &&visit)
{
  if constexpr (requires { value.has_value(); }) {
    if (value) {
      for_each_number(*value, visit);
    }
  }
  else if constexpr (requires {
                       value.length();
                       value.x;
                     }) {
    for (int i = 0; i < value.length(); i++) {
      visit(double(value[i]));
    }
  }
  else if constexpr (std::is_arithmetic_v<Value> && !std::is_same_v<Value, bool>) {
    visit(double(value));
  }
}

/** The range_fault of the first number of \a settings that is out of its limits. Empty: all are within. */
template <typename Settings>
[[nodiscard]] std::string limit_fault(const Settings &settings)
{
  std::string fault;
  Settings::for_each_property([&](const auto &row) {
    for_each_number(row.access(settings), [&](double number) {
      if (fault.empty() && !row.allows(number)) {
        fault = range_fault(row, number);
      }
    });
  });
  return fault;
}

/** A property that is a member of a T. */
template <typename T, typename ValueType>
struct Property : Description {
  using Value = ValueType;
  Value T::*member;

  [[nodiscard]] constexpr const Value &access(const T &thing) const
  {
    return thing.*member;
  }
  [[nodiscard]] constexpr Value &access(T &thing) const
  {
    return thing.*member;
  }
};

template <typename T, typename Value>
[[nodiscard]] constexpr Property<T, Value> property(Value T::*member, const Description &description)
{
  return {description, member};
}

/** A property whose value is nested in a T. `access` returns a reference to it. */
template <typename ValueType, typename Access>
struct PartProperty : Description {
  using Value = ValueType;
  Access access;
};

/** \a access: takes a T, constant or not, as `[](auto &thing) -> auto & { return thing.part.member; }` */
template <typename T, typename Access>
[[nodiscard]] constexpr auto part_property(Access access, const Description &description)
{
  return PartProperty<std::decay_t<std::invoke_result_t<Access, T &>>, Access>{description, access};
}

/** The description of the property of a T that is named \a name. \pre there is one */
template <typename T>
[[nodiscard]] constexpr Description description_of(std::string_view name)
{
  Description found;
  T::for_each_property([&](const Description &row) { found = row.name == name ? row : found; });
  return found;
}

}  // namespace gnomon::scene
