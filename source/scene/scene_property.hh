// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>

/**
 * The type of the rows that describe properties: of things in scene_properties.hh. Checks, files, Python, the window
 * and the documentation read the rows, so that a property is described once.
 */
namespace gnomon::scene {

inline constexpr double float_max = std::numeric_limits<float>::max();

/** A bit for each of \a values of an enumeration. */
template <typename... Values>
[[nodiscard]] constexpr unsigned bits(Values... values)
{
  return ((1U << unsigned(values)) | ...);
}

/** What a property means and which values it may have. Members that are left out have no meaning for the property. */
struct Description {
  /** Of the member; in messages and in Python. */
  std::string_view name;
  /** In scripts of the window and, after a prefix, in extras of files. Empty: as `name`. */
  std::string_view key{};
  /** In the window. */
  std::string_view label{};
  /** A header that the window shows the property under. */
  std::string_view group{};
  /** Unit of the value. Angles are in "rad" here; the window shows degrees. */
  std::string_view unit{};
  /** Limits of a number, and of each component of a vector. */
  double min = 0.0;
  double max = float_max;
  /** Meaning of 0, where it is allowed beside the limits. */
  std::string_view zero{};
  /** A number that may be absent, or 0 beside the limits, begins with this in the window. */
  double first = 0.0;
  /** The kinds of a thing that have the property, as bits. 0: all. */
  unsigned kinds = 0;
  /** The kinds for which files have the property as an extra, as bits. */
  unsigned extra_kinds = 0;
  /** Extras have the angle in degrees. */
  bool is_extra_in_degrees = false;
  /** Place of the property in glTF, from its material, camera or lamp; empty: glTF has none. */
  std::string_view path{};
  /** KHR_animation_pointer animates it, by its path. */
  bool is_animated = false;
  /** The aspect of the thing that the property belongs to. */
  unsigned aspect = 0;
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
    return float(value) >= float(min) && float(value) <= float(max) && (value >= 0.0 || min < 0.0);
  }
  /** The allowed value next to \a value, which is not NaN. */
  [[nodiscard]] constexpr float nearest(double value) const
  {
    return allows(value) ? float(value) : value < min && !zero.empty() ? 0.0F : float(value < min ? min : max);
  }
};

/**
 * The limits as text: "from 0 to 1", "at least 0", "a finite number". \a factor: of the limits, for another unit than
 * that of the value.
 */
[[nodiscard]] std::string range_text(const Description &description, double factor = 1.0);

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

/** A property that is a member of a T. */
template <typename T, typename ValueType>
struct Property : Description {
  using Value = ValueType;
  Value T::*member;
};

template <typename T, typename Value>
[[nodiscard]] constexpr Property<T, Value> property(Value T::*member, const Description &description)
{
  return {description, member};
}

/** The words for the values of an enumeration, in their order: in files, options and scripts. */
template <typename Enum>
inline constexpr std::array<std::string_view, 0> words{};

}  // namespace gnomon::scene
