// SPDX-License-Identifier: MIT
#include "internal/gltf_json.hh"

#include <algorithm>

namespace gnomon::gltf {

std::string Place::text() const
{
  std::string result = outer == nullptr ? "" : outer->text() + '.';
  result += key;
  return index == no_index ? result : result + '[' + std::to_string(index) + ']';
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

std::uint64_t size_at(const Place &place, const JsonValue &value)
{
  std::uint64_t size = 0;
  if (value.get(size) != simdjson::SUCCESS) {
    fail(place, value, "a whole number, not negative");
  }
  return size;
}

int index_at(const Place &place, const JsonValue &value)
{
  std::uint64_t index = 0;
  if (value.get(index) != simdjson::SUCCESS || index > std::uint64_t(std::numeric_limits<int>::max())) {
    fail(place, value, "an index");
  }
  return static_cast<int>(index);
}

}  // namespace gnomon::gltf
