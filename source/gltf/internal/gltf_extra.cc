// SPDX-License-Identifier: MIT
#include "internal/gltf_extra.hh"

#include "internal/gltf_report.hh"

#include <cmath>
#include <utility>

namespace gnomon::gltf {

std::string Range::text() const
{
  if (least > 0.0) {
    return "from " + gltf::text(least) + " to " + gltf::text(max) + ", or the negative of such a number";
  }
  return "from " + gltf::text(min) + " to " + gltf::text(max) + (zero.empty() || min <= 0.0 ? "" : ", or 0");
}

std::string written(const Model::Extra &extra)
{
  if (const auto *number = std::get_if<double>(&extra)) {
    return text(*number);
  }
  if (const auto *string = std::get_if<std::string>(&extra)) {
    return '\'' + printable(*string) + '\'';
  }
  const auto *boolean = std::get_if<bool>(&extra);
  return boolean == nullptr ? "an array" : *boolean ? "true" : "false";
}

ExtraReader::ExtraReader(const Model::Extras &extras, std::string what) : extras_(extras), what_(std::move(what)) {}

void ExtraReader::fail(std::string_view key, const std::string &value, const std::string &wanted) const
{
  throw Fault(what_, std::string(key) + " is " + value + ", and must be " + wanted);
}

float ExtraReader::checked(std::string_view key, double value, const Range &range) const
{
  if (!range.contains(value)) {
    fail(key, text(value), range.text());
  }
  return static_cast<float>(value);
}

const Model::Extra *ExtraReader::find(std::string_view key) const
{
  const auto found = extras_.find(key);
  return found == extras_.end() ? nullptr : &found->second;
}

std::optional<double> ExtraReader::number_if_any(std::string_view key, const Range &range) const
{
  const Model::Extra *extra = find(key);
  if (extra == nullptr) {
    return std::nullopt;
  }
  const double *number = std::get_if<double>(extra);
  if (number == nullptr) {
    fail(key, written(*extra), "a number " + range.text());
  }
  static_cast<void>(checked(key, *number, range));
  return *number;
}

float ExtraReader::number(std::string_view key, double fallback, const Range &range) const
{
  return static_cast<float>(number_if_any(key, range).value_or(fallback));
}

std::optional<int> ExtraReader::whole_if_any(std::string_view key, const Range &range) const
{
  const std::optional<double> value = number_if_any(key, range);
  if (value && *value != std::floor(*value)) {
    fail(key, text(*value), "a whole number");
  }
  return value ? std::optional(static_cast<int>(*value)) : std::nullopt;
}

std::string ExtraReader::string(std::string_view key, const char *fallback) const
{
  const Model::Extra *extra = find(key);
  if (extra == nullptr) {
    return fallback;
  }
  const std::string *text = std::get_if<std::string>(extra);
  if (text == nullptr) {
    fail(key, written(*extra), "a string");
  }
  return *text;
}

glm::vec3 ExtraReader::color(std::string_view key, const glm::vec3 &fallback, const Range &range) const
{
  const Model::Extra *extra = find(key);
  if (extra == nullptr) {
    return fallback;
  }
  const auto *numbers = std::get_if<std::vector<double>>(extra);
  if (numbers == nullptr || numbers->size() != 3) {
    fail(key, written(*extra), "three numbers");
  }
  glm::vec3 result(0.0F);
  for (std::size_t i = 0; i < 3; i++) {
    result[int(i)] = checked(key, (*numbers)[i], range);
  }
  return result;
}

}  // namespace gnomon::gltf
