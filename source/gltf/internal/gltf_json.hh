// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_report.hh"

#include <simdjson.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

/** Values of a JSON document with their types checked. Internal to source/gltf. */
namespace gnomon::gltf {

using JsonValue = simdjson::dom::element;
using JsonObject = simdjson::dom::object;
using JsonArray = simdjson::dom::array;

/**
 * A place in the document. It links to the enclosing place, so that a text is created only for messages. The outermost
 * place is the document, which alone has `warnings`.
 */
struct Place {
  static constexpr std::size_t no_index = std::numeric_limits<std::size_t>::max();

  const Place *outer = nullptr;
  std::string_view key = {};
  std::size_t index = no_index;
  /** An element of one of the document's arrays; otherwise nullptr. */
  const JsonValue *element = nullptr;
  Warnings *warnings = nullptr;

  /** For example "nodes[3].mesh". */
  [[nodiscard]] std::string text() const;
  /** For example "node 'wheel'" for an element of one of the document's arrays; otherwise text(). */
  [[nodiscard]] std::string label() const;
  /** Adds a warning about the place. Equal reasons are counted. */
  void warn(std::string_view reason) const;
};

/**
 * Appends ".0" to whole numbers that may exceed 64 bits, which JSON allows and simdjson refuses, and \a padding bytes
 * to the document.
 */
[[nodiscard]] std::string with_long_numbers_as_floats(std::string_view json, std::size_t padding);

/**
 * Parses \a json, which document_padding() bytes follow. Whole numbers above 64 bits are read as floats. \a changed:
 * the text that is then parsed. \a value: as long as \a parser
 */
[[nodiscard]] simdjson::error_code parse_json(simdjson::dom::parser &parser, std::string_view json,
                                              std::string &changed, JsonValue &value);

/** The text of a value, shortened. */
[[nodiscard]] std::string quoted(const JsonValue &value);

/** \throws Fault: "place: is value, and must be wanted". */
[[noreturn]] void fail(const Place &place, const JsonValue &value, std::string_view wanted);

/** \throws Fault: "place: has no missing". */
[[noreturn]] void fail_incomplete(const Place &place, const std::string &missing);

/** The functions below throw a Fault that names the place, if the value has another type or is out of range. */
[[nodiscard]] JsonObject object_at(const Place &place, const JsonValue &value);
/** \a wanted: expected type, for the message. */
[[nodiscard]] JsonArray array_at(const Place &place, const JsonValue &value, std::string_view wanted = "an array");
[[nodiscard]] std::string string_at(const Place &place, const JsonValue &value);
/** A string of at most 1024 bytes, because names are copied to every object. */
[[nodiscard]] std::string name_at(const Place &place, const JsonValue &value);
[[nodiscard]] bool boolean_at(const Place &place, const JsonValue &value);
[[nodiscard]] double number_at(const Place &place, const JsonValue &value);
/** A whole number, at least 0. One that is written as a float ("5126.0") is read with a warning. */
[[nodiscard]] std::uint64_t size_at(const Place &place, const JsonValue &value);
/** A whole number in [0, INT_MAX]. */
[[nodiscard]] int index_at(const Place &place, const JsonValue &value);

/** An array of as many numbers as \a numbers has. */
void read_numbers(const Place &place, const JsonValue &value, std::span<double> numbers);

/** A member that read_members looks for. */
template <typename Read>
struct Member {
  std::string_view key;
  /** Called with the member's Place and JsonValue. */
  Read read;
};
template <typename Read>
Member(std::string_view, Read) -> Member<Read>;

/** A member that is stored in \a target. The type of \a target determines the member's type; an int is an index. An
 * optional target stays empty if the member is absent. */
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
                  else if constexpr (std::is_same_v<T, double> || std::is_same_v<T, std::optional<double>>) {
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

/** Warns that the importer does not read the extension \a name of the object at \a extensions.outer. */
void warn_unread_extension(const Place &extensions, std::string_view name);

/** A warning about a member. */
inline constexpr std::string_view twice_text = "stands twice in the object; the last counts";

/** The key of extensions in all objects of glTF. */
inline constexpr std::string_view extensions_key = "extensions";

/** The start of the keys of Gnomon's own extras. */
inline constexpr std::string_view own_extra_prefix = "gnomon_";

/** The key of what programs may add to all objects of glTF. */
inline constexpr std::string_view extras_key = "extras";

/** Notes that programs other than Gnomon have added members to the object at \a place: to keep, or lost. */
void note_foreign_extras(const Place &place, const JsonValue &extras);

/** A member that read_members did not look for. Names the extensions that it has. */
void skip_member(const Place &place, const Place &at, const JsonValue &member);

/**
 * Reads those of \a members that the object has. Extensions without a member are named in warnings, and so are members
 * that the object has twice, of which the last counts. \throws Fault if \a value is not an object, and what the members
 * throw.
 */
template <typename... Read>
void read_members(const Place &place, const JsonValue &value, const Member<Read> &...members)
{
  static_assert(sizeof...(Read) <= 64);
  std::uint64_t read = 0;
  for (const auto [key, member] : object_at(place, value)) {
    const Place at{&place, key};
    std::uint64_t bit = 1;
    if (key == extras_key) {
      note_foreign_extras(place, member);
    }
    const bool is_read = ((members.key == key ? (members.read(at, member), true) : (bit <<= 1U, false)) || ...);
    if (!is_read) {
      if (key == extensions_key || place.key == extensions_key) {
        skip_member(place, at, member);
      }
    }
    else if ((read & bit) != 0) {
      at.warn(twice_text);
    }
    read |= bit;
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
