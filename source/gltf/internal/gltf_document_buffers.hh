// SPDX-License-Identifier: MIT
#pragma once

#include "internal/gltf_json.hh"
#include "internal/gltf_model.hh"

#include <map>
#include <vector>

/** Reads the buffers, buffer views and accessors of a document. Internal to source/gltf. */
namespace gnomon::gltf {

/** Checks indices into the arrays of a document. */
class DocumentIndices {
 public:
  /** \a array: its key; it must outlive the indices. An array without a size is empty. */
  void set_size(std::string_view array, std::size_t size)
  {
    sizes_[array] = size;
  }

  /** \throws Fault that names the place, if \a value is not an index into \a array. */
  [[nodiscard]] int index_into(std::string_view array, const Place &place, const JsonValue &value) const;
  [[nodiscard]] std::vector<int> indices_into(std::string_view array, const Place &place, const JsonValue &value) const;

  /** Members for read_members(). The indices must outlive them. */
  [[nodiscard]] auto into_index(std::string_view key, int &target, std::string_view array) const
  {
    return Member{key, [this, &target, array](const Place &place, const JsonValue &value) {
                    target = index_into(array, place, value);
                  }};
  }
  [[nodiscard]] auto into_indices(std::string_view key, std::vector<int> &target, std::string_view array) const
  {
    return Member{key, [this, &target, array](const Place &place, const JsonValue &value) {
                    target = indices_into(array, place, value);
                  }};
  }

 private:
  std::map<std::string_view, std::size_t> sizes_;
};

/** All of these throw a Fault that names the place. */
void read_accessor(const Place &place, const JsonValue &value, const DocumentIndices &indices,
                   Model::Accessor &accessor);
void read_buffer_view(const Place &place, const JsonValue &value, const DocumentIndices &indices,
                      Model::BufferView &view);
void read_buffer(const Place &place, const JsonValue &value, Model::Buffer &buffer);

}  // namespace gnomon::gltf
