// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_model.hh"
#include "scene_properties.hh"

#include <glm/vec3.hpp>

#include <algorithm>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** Numbers from min to max, as they are stored in float. */
struct Range {
  double min;
  double max;
  /** \see scene::Description::least */
  double least = 0.0;
  /** \see scene::Description::zero */
  std::string_view zero{};

  [[nodiscard]] bool contains(double value) const
  {
    return scene::Description{.name = "", .min = min, .max = max, .least = least, .zero = zero}.allows(value);
  }
  [[nodiscard]] std::string text() const;
};

/** Key of a property in the extras of files. */
[[nodiscard]] inline std::string extra_key(const scene::Description &row)
{
  return "gnomon_" + std::string(row.key_or_name());
}

/** Unit of a property in the extras over its unit in the scene. */
[[nodiscard]] inline double extra_factor(const scene::Description &row)
{
  return row.is_extra_in_degrees ? 180.0 / std::numbers::pi : 1.0;
}

/** The limits of a property in a file. \a factor: unit of the file over that of the scene */
[[nodiscard]] inline Range range_of(const scene::Description &row, double factor = 1.0)
{
  // A limit is a float: the exporter writes a value that is at it as its product with the factor.
  return {double(float(row.min)) * factor, double(float(row.max)) * factor, row.least * factor, row.zero};
}

/** The range of the property \a name of a T. \a factor: as above. */
template <typename T>
[[nodiscard]] Range range_of(std::string_view name, double factor = 1.0)
{
  return range_of(scene::description_of<T>(name), factor);
}

/** The text of an extra for messages. */
[[nodiscard]] std::string written(const Model::Extra &extra);

/**
 * Reads the extras of one thing. Functions that read throw a Fault that names the thing, the key and the value, if the
 * value has the wrong type or is out of range.
 */
class ExtraReader {
 public:
  /** \a extras must outlive the reader. \a what: the thing, as in "lamp 'a'". */
  ExtraReader(const Model::Extras &extras, std::string what);

  [[nodiscard]] const Model::Extras &extras() const
  {
    return extras_;
  }
  [[nodiscard]] const std::string &what() const
  {
    return what_;
  }
  [[noreturn]] void fail(std::string_view key, const std::string &value, const std::string &wanted) const;

  /** \a value of any property, in float. */
  [[nodiscard]] float checked(std::string_view key, double value, const Range &range) const;

  /** nullptr if the key is absent. */
  [[nodiscard]] const Model::Extra *find(std::string_view key) const;
  [[nodiscard]] std::optional<double> number_if_any(std::string_view key, const Range &range) const;
  [[nodiscard]] float number(std::string_view key, double fallback, const Range &range) const;
  /** Blender may write whole numbers as floats. */
  [[nodiscard]] std::optional<int> whole_if_any(std::string_view key, const Range &range) const;
  [[nodiscard]] std::string string(std::string_view key, const char *fallback) const;
  /** Three numbers. */
  [[nodiscard]] glm::vec3 color(std::string_view key, const glm::vec3 &fallback, const Range &range) const;
  /** The enumerator whose word is the extra's value. */
  template <typename Word>
  [[nodiscard]] Word word(const std::string &key) const;
  /** Sets the properties of \a part, of a thing of \a kind, that the file has as extras. */
  template <typename Part>
  void read_properties(unsigned kind, Part &part) const;

 private:
  /** \pre the file has it */
  template <typename Value>
  void read_property(const scene::Description &row, const std::string &key, Value &value) const;

  const Model::Extras &extras_;
  std::string what_;
};

template <typename Word>
Word ExtraReader::word(const std::string &key) const
{
  constexpr auto &words = scene::words<Word>;
  const std::string value = string(key, "");
  const auto found = std::find(words.begin(), words.end(), value);
  if (found == words.end()) {
    std::string wanted;
    for (std::size_t i = 0; i < words.size(); i++) {
      wanted += i == 0 ? "" : i + 1 == words.size() ? " or " : ", ";
      wanted += '\'' + std::string(words[i]) + '\'';
    }
    fail(key, '\'' + printable(value) + '\'', wanted);
  }
  return static_cast<Word>(found - words.begin());
}

template <typename Value>
void ExtraReader::read_property(const scene::Description &row, const std::string &key, Value &value) const
{
  const double factor = extra_factor(row);
  const Range range = range_of(row, factor);
  if constexpr (requires { value.has_value(); }) {
    read_property(row, key, value.emplace());
  }
  else if constexpr (std::is_same_v<Value, scene::AreaShape>) {
    // It has more words than values.
  }
  else if constexpr (std::is_enum_v<Value>) {
    value = word<Value>(key);
  }
  else if constexpr (std::is_same_v<Value, int>) {
    value = *whole_if_any(key, range);
  }
  else if constexpr (std::is_same_v<Value, float>) {
    value = static_cast<float>(*number_if_any(key, range) / factor);
  }
  else if constexpr (std::is_same_v<Value, glm::vec3>) {
    value = color(key, value, range);
  }
}

template <typename Part>
void ExtraReader::read_properties(unsigned kind, Part &part) const
{
  Part::for_each_property([&](const auto &row) {
    const std::string key = extra_key(row);
    if (row.has_extra(kind) && find(key) != nullptr) {
      read_property(row, key, part.*row.member);
    }
  });
}

}  // namespace gnomon::gltf
