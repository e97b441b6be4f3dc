// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_model.hh"
#include "internal/gltf_units.hh"

#include <glm/vec3.hpp>

#include <optional>
#include <string>
#include <string_view>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** Numbers from min to max. */
struct Range {
  double min;
  double max;

  [[nodiscard]] bool contains(double value) const
  {
    return value >= min && value <= max;
  }
  [[nodiscard]] std::string text() const;
};

constexpr Range not_negative{0.0, large};
constexpr Range length_range{length_min, large};

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
  [[nodiscard]] float checked(const char *key, double value, const Range &range) const;

  /** nullptr if the key is absent. */
  [[nodiscard]] const Model::Extra *find(std::string_view key) const;
  [[nodiscard]] std::optional<double> number_if_any(const char *key, const Range &range) const;
  [[nodiscard]] float number(const char *key, double fallback, const Range &range) const;
  /** Blender may write whole numbers as floats. */
  [[nodiscard]] std::optional<int> whole_if_any(const char *key, const Range &range) const;
  [[nodiscard]] std::string string(const char *key, const char *fallback) const;
  /** Three numbers. */
  [[nodiscard]] glm::vec3 color(const char *key, const glm::vec3 &fallback, const Range &range) const;

 private:
  const Model::Extras &extras_;
  std::string what_;
};

}  // namespace gnomon::gltf
