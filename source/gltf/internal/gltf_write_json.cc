// SPDX-License-Identifier: MIT
#include "internal/gltf_write_json.hh"

#include "internal/gltf_report.hh"

#include <fmt/format.h>
#include <simdjson.h>

#include <cmath>
#include <cstdlib>

namespace gnomon::gltf {

namespace {

void check_finite(double value, std::string_view what)
{
  if (!std::isfinite(value)) {
    throw Fault(what, "one of its numbers is not finite");
  }
}

}  // namespace

std::string what_of(const char *kind, const std::string &name)
{
  return std::string(kind) + " '" + printable(name) + '\'';
}

std::string json_string(std::string_view text, std::string_view what)
{
  constexpr std::size_t size_max = 1024;
  if (text.size() > size_max) {
    throw Fault(what, "its name is longer than " + std::to_string(size_max) + " bytes");
  }
  if (!simdjson::validate_utf8(text.data(), text.size())) {
    throw Fault(what, "its name is not UTF-8");
  }
  std::string result = "\"";
  for (const char character : text) {
    const auto code = static_cast<unsigned char>(character);
    if (code < 0x20) {
      result += fmt::format("\\u{:04x}", code);
      continue;
    }
    if (character == '"' || character == '\\') {
      result += '\\';
    }
    result += character;
  }
  return result + '"';
}

std::string json_number(double value, std::string_view what)
{
  check_finite(value, what);
  return fmt::format("{}", value);
}

std::string json_number(float value, std::string_view what)
{
  check_finite(value, what);
  // Readers convert through double, which can round the shortest text of a float to a neighbouring float.
  std::string text = fmt::format("{}", value);
  return static_cast<float>(std::strtod(text.c_str(), nullptr)) == value ? text : fmt::format("{}", double(value));
}

std::string json_numbers(const glm::vec2 &value, std::string_view what)
{
  return '[' + json_number(value.x, what) + ',' + json_number(value.y, what) + ']';
}

std::string json_numbers(const glm::vec3 &value, std::string_view what)
{
  return '[' + json_number(value.x, what) + ',' + json_number(value.y, what) + ',' + json_number(value.z, what) + ']';
}

std::string json_numbers(const glm::vec4 &value, std::string_view what)
{
  return '[' + json_number(value.x, what) + ',' + json_number(value.y, what) + ',' + json_number(value.z, what) + ',' +
         json_number(value.w, what) + ']';
}

int JsonText::add(std::string_view value)
{
  text_ += text_.empty() ? "" : ",";
  text_ += value;
  return static_cast<int>(count_++);
}

void JsonText::add(std::string_view key, std::string_view value)
{
  text_ += text_.empty() ? "\"" : ",\"";
  text_ += key;
  text_ += "\":";
  text_ += value;
  count_++;
}

void JsonText::add_all(const JsonText &other)
{
  text_ += text_.empty() || other.empty() ? "" : ",";
  text_ += other.text_;
  count_ += other.count_;
}

}  // namespace gnomon::gltf
