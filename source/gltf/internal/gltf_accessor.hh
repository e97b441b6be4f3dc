// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_file.hh"

#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/**
 * The bytes of a buffer view from \a offset to its end.
 *
 * \throws Fault that names \a what, if the bytes are incomplete.
 */
[[nodiscard]] std::span<const unsigned char> view_bytes(const File &file, int view_index, std::size_t offset,
                                                        const std::string &what);

/**
 * Reads the elements of one accessor without copying its buffer. The constructor checks that all elements are within
 * the buffer. Memory use is bounded by the file's size.
 */
class AccessorReader {
 public:
  /** \throws Fault that names the accessor, if elements are missing or not of \a type. */
  AccessorReader(const File &file, int accessor_index, Model::ElementType type);

  [[nodiscard]] std::size_t count() const
  {
    return accessor_.count;
  }
  /** Whether the accessor has no bytes, so that all elements are zero. */
  [[nodiscard]] bool is_all_zero() const
  {
    return bytes_.empty() && sparse_indices_.empty();
  }
  /** Element of a VEC3, normalised if the accessor is. May be non-finite. \pre index < count(). */
  [[nodiscard]] glm::vec3 vec3(std::size_t index) const;
  /** The same for a VEC2. */
  [[nodiscard]] glm::vec2 vec2(std::size_t index) const;
  /** The same for a VEC4. */
  [[nodiscard]] glm::vec4 vec4(std::size_t index) const;
  /** The same of a SCALAR. */
  [[nodiscard]] float scalar(std::size_t index) const;
  /** The same of a MAT4. */
  [[nodiscard]] glm::mat4 mat4(std::size_t index) const;
  /** Element of a VEC4 of unsigned integers. \pre index < count(), and is_unsigned(). */
  [[nodiscard]] std::array<std::uint32_t, 4> integers(std::size_t index) const;
  /** Element of a VEC3 or VEC4 of colours; the alpha of a VEC3 is 1. */
  [[nodiscard]] glm::vec4 color(std::size_t index) const;
  /**
   * Whether components have a type that glTF allows for colours: float, or normalised unsigned integers of 8 or 16
   * bits.
   */
  [[nodiscard]] bool is_color() const;
  /** Element of a SCALAR of unsigned integers. \pre index < count(), and is_unsigned(). */
  [[nodiscard]] std::uint32_t integer(std::size_t index) const;
  [[nodiscard]] bool is_unsigned() const;

 private:
  const Model::Accessor &accessor_;
  std::string what_;
  std::size_t element_size_ = 0;
  std::size_t stride_ = 0;
  /** Begins with the first element. Empty: all elements are zero. */
  std::span<const unsigned char> bytes_;
  /** Ascending. */
  std::vector<std::uint32_t> sparse_indices_;
  std::span<const unsigned char> sparse_values_;

  void read_sparse(const File &file);
  /** nullptr for an element that is zero. */
  [[nodiscard]] const unsigned char *element(std::size_t index) const;
  [[nodiscard]] float component(const unsigned char *bytes) const;
};

}  // namespace gnomon::gltf
