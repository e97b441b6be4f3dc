// SPDX-License-Identifier: MIT
#include "internal/gltf_json.hh"

#include "internal/gltf_document.hh"
#include "internal/gltf_model.hh"
#include "memory_pages.hh"

#include <algorithm>
#include <cmath>
#include <optional>

namespace gnomon::gltf {

std::string Place::text() const
{
  const bool is_in_document = outer == nullptr || outer->outer == nullptr;
  std::string result = is_in_document ? "" : outer->text() + '.';
  result += key;
  return index == no_index ? result : result + '[' + std::to_string(index) + ']';
}

std::string Place::label() const
{
  if (element == nullptr) {
    return text();
  }
  // "meshes", and others that end with s.
  std::string_view kind = key;
  kind.remove_suffix(kind.ends_with("shes") ? 2 : kind.ends_with('s') ? 1 : 0);
  std::string_view name;
  if (element->at_key("name").get(name) != simdjson::SUCCESS) {
    name = {};
  }
  return gltf::label(kind, name, index);
}

/** The warnings of the document that \a place is in. */
static Warnings &warnings_of(const Place &place)
{
  const Place *document = &place;
  while (document->outer != nullptr) {
    document = document->outer;
  }
  return *document->warnings;
}

void Place::warn(std::string_view reason) const
{
  warnings_of(*this).add_counted(label(), 1, reason);
}

/** Whether read_foreign_extras() reads the extras of the object at \a place. */
static bool keeps_extras(const Place &place)
{
  if (place.outer == nullptr) {
    return true;
  }
  return place.element != nullptr ? std::ranges::count(arrays_with_kept_extras, place.key) > 0
                                  : place.key == lights_key && place.outer->key == punctual_key;
}

void note_foreign_extras(const Place &place, const JsonValue &extras)
{
  Warnings &warnings = warnings_of(place);
  const auto count = [&](std::string_view key) {
    warnings.add_foreign_extra([&] {
      return (key.empty() ? "" : '\'' + printable(key) + "' ") + "of " +
             (place.outer == nullptr ? "the document" : place.label());
    });
  };
  JsonObject object;
  if (extras.get(object) != simdjson::SUCCESS) {
    count("");
    return;
  }
  for (const auto [key, value] : object) {
    if (key.starts_with(own_extra_prefix)) {
      continue;
    }
    if (keeps_extras(place)) {
      warnings.note_kept_extras();
      return;
    }
    count(key);
  }
}

void warn_unread_extension(const Place &extensions, std::string_view name)
{
  const Place &owner = *extensions.outer;
  const bool is_document = owner.outer == nullptr;
  (is_document ? extensions : owner).warn(printable(name) + " is not read");
}

void skip_member(const Place &place, const Place &at, const JsonValue &member)
{
  if (place.key == extensions_key) {
    warn_unread_extension(place, at.key);
    return;
  }
  JsonObject extensions;
  if (at.key == extensions_key && member.get(extensions) == simdjson::SUCCESS) {
    for (const auto [name, value] : extensions) {
      warn_unread_extension(at, name);
    }
  }
}

std::string with_long_numbers_as_floats(std::string_view json, std::size_t padding)
{
  constexpr std::size_t length_min = 19;
  constexpr std::string_view number_characters = "+-.0123456789Ee";
  std::string result;
  bool is_in_string = false;
  for (std::size_t i = 0; i < json.size();) {
    const std::size_t end = std::min(json.find_first_not_of(number_characters, i), json.size());
    const std::string_view token = json.substr(i, end - i);
    if (!is_in_string && !token.empty()) {
      result += token;
      result += token.size() >= length_min && token.find_first_of(".Ee") == token.npos ? ".0" : "";
      i = end;
      continue;
    }
    const bool is_escape = is_in_string && json[i] == '\\';
    is_in_string = is_in_string != (json[i] == '"');
    const std::size_t count = std::min<std::size_t>(is_escape ? 2 : 1, json.size() - i);
    result += json.substr(i, count);
    i += count;
  }
  result.resize(result.size() + padding);
  return result;
}

/** Newer versions of simdjson (that of Debian 13) have a code of their own for whole numbers above 64 bits. */
template <class Code>
static bool is_number_error(Code error)
{
  if constexpr (requires { Code::BIGINT_ERROR; }) {
    if (error == Code::BIGINT_ERROR) {
      return true;
    }
  }
  return error == Code::NUMBER_ERROR;
}

/** Allocate the parser's output buffers for a text of this size. They need several times the size of the text. */
static simdjson::error_code allocate(simdjson::dom::parser &parser, std::size_t size)
{
  if (const simdjson::error_code error = parser.allocate(size); error != simdjson::SUCCESS) {
    return error;
  }
  if (const simdjson::error_code error = parser.doc.allocate(size); error != simdjson::SUCCESS) {
    return error;
  }
  memory::prefer_large_pages(parser.implementation->structural_indexes.get(), size * sizeof(std::uint32_t));
  memory::prefer_large_pages(parser.doc.tape.get(), size * sizeof(std::uint64_t));
  return simdjson::SUCCESS;
}

simdjson::error_code parse_json(simdjson::dom::parser &parser, std::string_view json, std::string &changed,
                                JsonValue &value)
{
  const auto parse = [&] { return parser.parse(json.data(), json.size(), false).get(value); };
  simdjson::error_code error = allocate(parser, json.size());
  error = error == simdjson::SUCCESS ? parse() : error;
  if (is_number_error(error)) {
    changed = with_long_numbers_as_floats(json, document_padding());
    json = std::string_view(changed).substr(0, changed.size() - document_padding());
    error = parse();
  }
  if (error == simdjson::DEPTH_ERROR) {
    // Parts of the document that are not read may have any depth.
    error = parser.allocate(json.size(), json.size());
    error = error == simdjson::SUCCESS ? parse() : error;
  }
  return error;
}

std::string quoted(const JsonValue &value)
{
  // Nested values are not printed, as they may have any depth.
  if (value.is_array() || value.is_object()) {
    return value.is_array() ? "an array" : "an object";
  }
  return printable(simdjson::minify(value));
}

void fail(const Place &place, const JsonValue &value, std::string_view wanted)
{
  throw Fault(place.text(), "is " + quoted(value) + ", and must be " + std::string(wanted));
}

void fail_incomplete(const Place &place, const std::string &missing)
{
  throw Fault("glTF", place.text() + ": has no " + missing);
}

JsonObject object_at(const Place &place, const JsonValue &value)
{
  JsonObject object;
  if (value.get(object) != simdjson::SUCCESS) {
    fail(place, value, "an object");
  }
  return object;
}

JsonArray array_at(const Place &place, const JsonValue &value, std::string_view wanted)
{
  JsonArray array;
  if (value.get(array) != simdjson::SUCCESS) {
    fail(place, value, wanted);
  }
  return array;
}

std::string string_at(const Place &place, const JsonValue &value)
{
  std::string_view text;
  if (value.get(text) != simdjson::SUCCESS) {
    fail(place, value, "a string");
  }
  return std::string(text);
}

std::string name_at(const Place &place, const JsonValue &value)
{
  constexpr std::size_t size_max = 1024;
  std::string name = string_at(place, value);
  if (name.size() > size_max) {
    throw Fault(place.text(), "is longer than " + std::to_string(size_max) + " bytes");
  }
  return name;
}

bool boolean_at(const Place &place, const JsonValue &value)
{
  bool boolean = false;
  if (value.get(boolean) != simdjson::SUCCESS) {
    fail(place, value, "true or false");
  }
  return boolean;
}

double number_at(const Place &place, const JsonValue &value)
{
  double number = 0.0;
  if (value.get(number) != simdjson::SUCCESS) {
    fail(place, value, "a number");
  }
  return number;
}

void read_numbers(const Place &place, const JsonValue &value, std::span<double> numbers)
{
  std::size_t count = 0;
  JsonArray array;
  bool is_right = value.get(array) == simdjson::SUCCESS;
  if (is_right) {
    for (const JsonValue element : array) {
      is_right = is_right && count < numbers.size() && element.get(numbers[count]) == simdjson::SUCCESS;
      count++;
    }
  }
  if (!is_right || count != numbers.size()) {
    fail(place, value, "an array of " + std::to_string(numbers.size()) + " numbers");
  }
}

/** The whole number of \a value, at least 0; empty if it is none. */
static std::optional<std::uint64_t> whole_number(const Place &place, const JsonValue &value)
{
  // Larger floats have lost digits.
  constexpr double exact_max = 9007199254740992.0;
  std::uint64_t number = 0;
  if (value.get(number) == simdjson::SUCCESS) {
    return number;
  }
  double real = 0.0;
  if (value.get(real) != simdjson::SUCCESS || !(real >= 0.0 && real <= exact_max) || std::trunc(real) != real) {
    return std::nullopt;
  }
  place.warn("a whole number is written as a float");
  return static_cast<std::uint64_t>(real);
}

std::uint64_t size_at(const Place &place, const JsonValue &value)
{
  const std::optional<std::uint64_t> size = whole_number(place, value);
  if (!size) {
    fail(place, value, "a whole number, not negative");
  }
  return *size;
}

int index_at(const Place &place, const JsonValue &value)
{
  const std::optional<std::uint64_t> index = whole_number(place, value);
  if (!index || *index > std::uint64_t(std::numeric_limits<int>::max())) {
    fail(place, value, "an index");
  }
  return static_cast<int>(*index);
}

}  // namespace gnomon::gltf
