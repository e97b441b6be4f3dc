// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_write_json.hh"
#include "scene.hh"

#include <span>
#include <string>
#include <vector>

/** Internal to source/gltf. */
namespace gnomon::gltf {

/** The binary data of a file under construction, with its glTF buffer views and accessors. */
struct WrittenBuffer {
  std::vector<unsigned char> bytes;
  JsonText views;
  JsonText accessors;

  /** \return the index of the new buffer view. */
  int add_view(std::span<const unsigned char> content);

  /**
   * Appends an accessor of \a values with components of \a component_type. \a more: further JSON members, each preceded
   * by a comma. \return its index.
   */
  template <typename T>
  int add_accessor(const std::vector<T> &values, int component_type, std::string_view type,
                   const std::string &more = {})
  {
    const auto *begin = reinterpret_cast<const unsigned char *>(values.data());
    const int view = add_view({begin, values.size() * sizeof(T)});
    return accessors.add(
        "{\"bufferView\":" + std::to_string(view) + ",\"componentType\":" + std::to_string(component_type) +
        ",\"count\":" + std::to_string(values.size()) + ",\"type\":\"" + std::string(type) + '"' + more + '}');
  }
};

/** Encodes \a image as a PNG file. \throws Fault that names \a what. */
[[nodiscard]] std::vector<unsigned char> png_of(const scene::Image &image, const std::string &what);

}  // namespace gnomon::gltf
