// SPDX-License-Identifier: MIT
#include "internal/gltf_document_buffers.hh"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

namespace gnomon::gltf {

int DocumentIndices::index_into(std::string_view array, const Place &place, const JsonValue &value) const
{
  const int index = index_at(place, value);
  const auto found = sizes_.find(array);
  const std::size_t size = found == sizes_.end() ? 0 : found->second;
  if (static_cast<std::size_t>(index) >= size) {
    throw Fault(place.text(), "index " + std::to_string(index) + " is out of range: the file has " +
                                  std::to_string(size) + ' ' + std::string(array));
  }
  return index;
}

std::vector<int> DocumentIndices::indices_into(std::string_view array, const Place &place, const JsonValue &value) const
{
  std::vector<int> indices;
  for (const JsonValue element : array_at(place, value, "an array of indices")) {
    indices.push_back(index_into(array, {place.outer, place.key, indices.size()}, element));
  }
  return indices;
}

namespace {

Model::ElementType element_type(const Place &place, const JsonValue &value)
{
  constexpr std::array types{
      std::pair{"SCALAR", Model::ElementType::Scalar}, std::pair{"VEC2", Model::ElementType::Vec2},
      std::pair{"VEC3", Model::ElementType::Vec3},     std::pair{"VEC4", Model::ElementType::Vec4},
      std::pair{"MAT2", Model::ElementType::Matrix},   std::pair{"MAT3", Model::ElementType::Matrix},
      std::pair{"MAT4", Model::ElementType::Matrix4}};
  const std::string name = string_at(place, value);
  const auto *const found =
      std::find_if(types.begin(), types.end(), [&](const auto &type) { return type.first == name; });
  if (found == types.end()) {
    fail(place, value, "a type of glTF 2.0");
  }
  return found->second;
}

void read_sparse(const Place &place, const JsonValue &value, const DocumentIndices &indices, Model::Sparse &sparse)
{
  const auto into_part = [&](std::string_view key, Model::SparsePart &part) {
    return Member{key, [&indices, &part](const Place &at, const JsonValue &member) {
                    read_members(at, member, indices.into_index("bufferView", part.buffer_view, "bufferViews"),
                                 into("byteOffset", part.byte_offset), into("componentType", part.component_type));
                    if (part.buffer_view < 0) {
                      fail_incomplete(at, "bufferView");
                    }
                  }};
  };
  read_members(place, value, into("count", sparse.count), into_part("indices", sparse.indices),
               into_part("values", sparse.values));
  if (sparse.indices.buffer_view < 0 || sparse.values.buffer_view < 0) {
    throw Fault(place.text(), sparse.indices.buffer_view < 0 ? "has no indices" : "has no values");
  }
}

void read_meshopt(const Place &place, const JsonValue &value, const DocumentIndices &indices, Model::Meshopt &meshopt)
{
  read_members(place, value, indices.into_index("buffer", meshopt.buffer, "buffers"),
               into("byteOffset", meshopt.byte_offset), into("byteLength", meshopt.byte_length),
               into("byteStride", meshopt.byte_stride), into("count", meshopt.count), into("mode", meshopt.mode),
               into("filter", meshopt.filter));
  if (meshopt.buffer < 0) {
    fail_incomplete(place, "buffer");
  }
}

}  // namespace

void read_accessor(const Place &place, const JsonValue &value, const DocumentIndices &indices,
                   Model::Accessor &accessor)
{
  std::optional<std::uint64_t> component_type;
  std::optional<std::uint64_t> count;
  std::optional<Model::ElementType> type;
  read_members(
      place, value, indices.into_index("bufferView", accessor.buffer_view, "bufferViews"),
      into("byteOffset", accessor.byte_offset), into("normalized", accessor.is_normalized),
      Member{"componentType", [&](const Place &at, const JsonValue &member) { component_type = size_at(at, member); }},
      Member{"count", [&](const Place &at, const JsonValue &member) { count = size_at(at, member); }},
      Member{"type", [&](const Place &at, const JsonValue &member) { type = element_type(at, member); }},
      Member{"sparse", [&](const Place &at, const JsonValue &member) {
               read_sparse(at, member, indices, accessor.sparse.emplace(Model::Sparse{}));
             }});
  if (!component_type || !count || !type) {
    fail_incomplete(place, !type ? "type" : !count ? "count" : "componentType");
  }
  accessor.component_type = *component_type;
  accessor.count = *count;
  accessor.type = *type;
}

void read_buffer_view(const Place &place, const JsonValue &value, const DocumentIndices &indices,
                      Model::BufferView &view)
{
  std::optional<std::uint64_t> length;
  read_members(place, value, indices.into_index("buffer", view.buffer, "buffers"), into("byteOffset", view.byte_offset),
               into("byteStride", view.byte_stride),
               Member{"byteLength", [&](const Place &at, const JsonValue &member) { length = size_at(at, member); }},
               Member{"extensions", [&](const Place &at, const JsonValue &extensions) {
                        read_members(at, extensions,
                                     Member{"EXT_meshopt_compression", [&](const Place &in, const JsonValue &member) {
                                              read_meshopt(in, member, indices, view.meshopt.emplace(Model::Meshopt{}));
                                            }});
                      }});
  if (view.buffer < 0 || !length) {
    fail_incomplete(place, view.buffer < 0 ? "buffer" : "byteLength");
  }
  view.byte_length = *length;
  if (view.byte_stride > 252 || view.byte_stride % 4 != 0) {
    throw Fault("glTF", "Invalid `byteStride' of " + place.text() + ": " + std::to_string(view.byte_stride) +
                            " is not a multiple of 4 up to 252");
  }
}

void read_buffer(const Place &place, const JsonValue &value, Model::Buffer &buffer)
{
  // A fallback without bytes is not read, as the buffer views name the compressed bytes.
  const auto skip = [](const Place &, const JsonValue &) {};
  read_members(place, value, into("byteLength", buffer.byte_length),
               Member{"uri", [&](const Place &at, const JsonValue &uri) { buffer.uri = string_at(at, uri); }},
               Member{"extensions", [&](const Place &at, const JsonValue &extensions) {
                        read_members(at, extensions, Member{"EXT_meshopt_compression", skip});
                      }});
}

}  // namespace gnomon::gltf
