// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <string>
#include <string_view>

/** JSON text. Internal to source/gltf. */
namespace gnomon::gltf {

/** The kind and the name of a thing of the scene, for messages. */
[[nodiscard]] std::string what_of(const char *kind, const std::string &name);

/** A quoted string. \throws Fault that names \a what if \a text is not UTF-8 or has more than 1024 bytes. */
[[nodiscard]] std::string json_string(std::string_view text, std::string_view what);

/** The shortest text that is read as the same value. \throws Fault that names \a what if the value is not finite. */
[[nodiscard]] std::string json_number(double value, std::string_view what);
[[nodiscard]] std::string json_number(float value, std::string_view what);
[[nodiscard]] std::string json_numbers(const glm::vec2 &value, std::string_view what);
[[nodiscard]] std::string json_numbers(const glm::vec3 &value, std::string_view what);
[[nodiscard]] std::string json_numbers(const glm::vec4 &value, std::string_view what);

/** Builder of an array or object. The values are JSON text. */
class JsonText {
 public:
  [[nodiscard]] bool empty() const
  {
    return text_.empty();
  }
  [[nodiscard]] std::size_t size() const
  {
    return count_;
  }
  /** Appends an element. \return its index */
  int add(std::string_view value);
  /** Appends a member. \a key: needs no escaping. */
  void add(std::string_view key, std::string_view value);
  /** Appends what \a other has. */
  void add_all(const JsonText &other);
  [[nodiscard]] std::string array() const
  {
    return '[' + text_ + ']';
  }
  [[nodiscard]] std::string object() const
  {
    return '{' + text_ + '}';
  }

 private:
  std::string text_;
  std::size_t count_ = 0;
};

}  // namespace gnomon::gltf
