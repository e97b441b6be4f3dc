// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_model.hh"
#include "internal/gltf_units.hh"
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

  [[nodiscard]] bool contains(double value) const
  {
    return scene::Description{.name = "", .min = min, .max = max, .least = least}.allows(value);
  }
  [[nodiscard]] std::string text() const;
};

constexpr Range not_negative{0.0, large};
constexpr Range length_range{length_min, large};

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
  return {std::max(row.min, -large) * factor, std::min(row.max, large) * factor, row.least * factor};
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

 private:
  const Model::Extras &extras_;
  std::string what_;
};

}  // namespace gnomon::gltf
