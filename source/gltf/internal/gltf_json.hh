// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_report.hh"

#include <simdjson.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>

/** Values of a JSON document with their types checked. Internal to source/gltf. */
namespace gnomon::gltf {

/** A place in the document. Linked to the place around it, so that its text is made only for a message. */
struct Place {
  static constexpr std::size_t no_index = std::numeric_limits<std::size_t>::max();

  const Place *outer = nullptr;
  std::string_view key = {};
  std::size_t index = no_index;

  /** As in "nodes[3].mesh". */
  [[nodiscard]] std::string text() const;
};

using JsonValue = simdjson::dom::element;
using JsonObject = simdjson::dom::object;
using JsonArray = simdjson::dom::array;

/**
 * A document in which whole numbers that may not fit into 64 bits end in ".0", followed by \a padding bytes. JSON
 * allows such numbers; simdjson reads them with a fraction only.
 */
[[nodiscard]] std::string with_long_numbers_as_floats(std::string_view json, std::size_t padding);

/** A value as it stands in the file, cut short. */
[[nodiscard]] std::string quoted(const JsonValue &value);

/** \throws Fault: "place: is value, and must be wanted". */
[[noreturn]] void fail(const Place &place, const JsonValue &value, std::string_view wanted);

/** The functions below throw a Fault that names the place where the value is of another type or out of range. */
[[nodiscard]] JsonObject object_at(const Place &place, const JsonValue &value);
/** \a wanted is for the message. */
[[nodiscard]] JsonArray array_at(const Place &place, const JsonValue &value, std::string_view wanted = "an array");
[[nodiscard]] std::string string_at(const Place &place, const JsonValue &value);
/** Of at most 1024 bytes: names are copied to every object. */
[[nodiscard]] std::string name_at(const Place &place, const JsonValue &value);
[[nodiscard]] bool boolean_at(const Place &place, const JsonValue &value);
[[nodiscard]] double number_at(const Place &place, const JsonValue &value);
/** A whole number of at least 0. */
[[nodiscard]] std::uint64_t size_at(const Place &place, const JsonValue &value);
/** A whole number that an int holds, of at least 0. */
[[nodiscard]] int index_at(const Place &place, const JsonValue &value);

template <std::size_t Count>
void read_numbers(const Place &place, const JsonValue &value, std::array<double, Count> &numbers)
{
  std::array<double, Count> read;
  std::size_t count = 0;
  JsonArray array;
  bool is_right = value.get(array) == simdjson::SUCCESS;
  if (is_right) {
    for (const JsonValue element : array) {
      is_right = is_right && count < Count && element.get(read[count]) == simdjson::SUCCESS;
      count++;
    }
  }
  if (!is_right || count != Count) {
    fail(place, value, "an array of " + std::to_string(Count) + " numbers");
  }
  numbers = read;
}

/** A member that read_members looks for. */
template <typename Read>
struct Member {
  std::string_view key;
  /** Takes the member's Place and JsonValue. */
  Read read;
};
template <typename Read>
Member(std::string_view, Read) -> Member<Read>;

/** A member that is stored in \a target, whose type says what the member must be; an int is an index. */
template <typename T>
auto into(std::string_view key, T &target)
{
  return Member{key, [&target](const Place &place, const JsonValue &value) {
                  if constexpr (std::is_same_v<T, std::string>) {
                    target = string_at(place, value);
                  }
                  else if constexpr (std::is_same_v<T, bool>) {
                    target = boolean_at(place, value);
                  }
                  else if constexpr (std::is_same_v<T, int>) {
                    target = index_at(place, value);
                  }
                  else if constexpr (std::is_same_v<T, std::uint64_t>) {
                    target = size_at(place, value);
                  }
                  else if constexpr (std::is_same_v<T, double>) {
                    target = number_at(place, value);
                  }
                  else {
                    read_numbers(place, value, target);
                  }
                }};
}

/** The member "name", at most 1024 bytes long. */
inline auto into_name(std::string &name)
{
  return Member{"name", [&name](const Place &place, const JsonValue &value) { name = name_at(place, value); }};
}

/** Reads those \a members that an object has. \throws Fault where \a value is no object, and what the members throw. */
template <typename... Read>
void read_members(const Place &place, const JsonValue &value, const Member<Read> &...members)
{
  for (const auto [key, member] : object_at(place, value)) {
    const Place at{&place, key};
    static_cast<void>(((members.key == key && (members.read(at, member), true)) || ...));
  }
}

/** Calls \a read(key, place, value) for each member of an object. */
template <typename Read>
void for_members(const Place &place, const JsonValue &value, const Read &read)
{
  for (const auto [key, member] : object_at(place, value)) {
    read(key, Place{&place, key}, member);
  }
}

}  // namespace gnomon::gltf
