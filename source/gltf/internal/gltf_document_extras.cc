// SPDX-License-Identifier: MIT
#include "internal/gltf_document_extras.hh"

#include "internal/gltf_report.hh"

#include <optional>
#include <utility>

namespace gnomon::gltf {

/** Empty if the value cannot be an extra. */
static std::optional<Model::Extra> extra_of(const JsonValue &value)
{
  constexpr std::size_t array_size_max = 4;
  if (bool boolean = false; value.get(boolean) == simdjson::SUCCESS) {
    return boolean;
  }
  if (double number = 0.0; value.get(number) == simdjson::SUCCESS) {
    return number;
  }
  if (std::string_view text; value.get(text) == simdjson::SUCCESS) {
    return std::string(text);
  }
  JsonArray array;
  if (value.get(array) != simdjson::SUCCESS || array.size() == 0 || array.size() > array_size_max) {
    return std::nullopt;
  }
  std::vector<double> numbers;
  for (const JsonValue element : array) {
    if (element.get(numbers.emplace_back()) != simdjson::SUCCESS) {
      return std::nullopt;
    }
  }
  return numbers;
}

void read_extras(const Place &place, const std::string &name, const JsonValue &value, Model::Extras &extras)
{
  JsonObject object;
  if (value.get(object) != simdjson::SUCCESS) {
    return;
  }
  for (const auto [key, extra] : object) {
    if (!key.starts_with(own_extra_prefix)) {
      continue;
    }
    std::optional<Model::Extra> read = extra_of(extra);
    if (!read) {
      const std::string what = name.empty() ? "" : " '" + printable(name) + "'";
      throw Fault(place.text() + what, "extra " + printable(key) + " is " + quoted(extra) +
                                           ", and must be a number, a string or a few numbers");
    }
    extras.insert_or_assign(std::string(key), std::move(*read));
  }
}

}  // namespace gnomon::gltf
