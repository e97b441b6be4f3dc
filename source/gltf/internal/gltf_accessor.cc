// SPDX-License-Identifier: MIT
#include "internal/gltf_accessor.hh"

#include "internal/gltf_report.hh"

#include <algorithm>
#include <cstring>
#include <limits>

namespace gnomon::gltf {

namespace {

/** Limit of accessors without a buffer view, which the size of the file does not limit. */
constexpr std::size_t empty_count_max = std::size_t(1) << 24U;

std::size_t component_size(std::uint64_t component_type)
{
  switch (component_type) {
    case Model::Byte:
    case Model::UnsignedByte: return 1;
    case Model::Short:
    case Model::UnsignedShort: return 2;
    case Model::UnsignedInt:
    case Model::Float: return 4;
    default: return 0;
  }
}

template <typename T>
T loaded(const unsigned char *bytes)
{
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

std::uint32_t loaded_integer(const unsigned char *bytes, std::size_t size)
{
  switch (size) {
    case 1: return loaded<std::uint8_t>(bytes);
    case 2: return loaded<std::uint16_t>(bytes);
    default: return loaded<std::uint32_t>(bytes);
  }
}

/** glTF 2.0, section 3.11: -1 has two representations in a signed normalised integer. */
template <typename T>
float from_integer(const unsigned char *bytes, bool is_normalized)
{
  const auto value = static_cast<float>(loaded<T>(bytes));
  return is_normalized ? std::max(value / static_cast<float>(std::numeric_limits<T>::max()), -1.0F) : value;
}

/** Whether \a count elements, each \a stride after the last, lie within \a size bytes. */
bool fits(std::size_t size, std::size_t count, std::size_t stride, std::size_t element_size)
{
  return count == 0 || (size >= element_size && count - 1 <= (size - element_size) / stride);
}

struct TypeName {
  std::size_t width;
  const char *name;
};

TypeName name_of(Model::ElementType type)
{
  switch (type) {
    case Model::ElementType::Scalar: return {1, "SCALAR"};
    case Model::ElementType::Vec2: return {2, "VEC2"};
    case Model::ElementType::Vec3: return {3, "VEC3"};
    case Model::ElementType::Vec4: return {4, "VEC4"};
    case Model::ElementType::Matrix4: return {16, "MAT4"};
    case Model::ElementType::Matrix: break;
  }
  return {16, "matrix"};
}

}  // namespace

std::span<const unsigned char> view_bytes(const File &file, int view_index, std::size_t offset, const std::string &what)
{
  const Model::BufferView &view = file.model.buffer_views[view_index];
  const std::span<const unsigned char> buffer = file.buffers[view.buffer];
  if (buffer.empty()) {
    throw Fault(what, "buffer " + std::to_string(view.buffer) + " holds no data");
  }
  if (view.byte_offset > buffer.size() || view.byte_length > buffer.size() - view.byte_offset) {
    throw Fault(what, "bufferView " + std::to_string(view_index) + " runs past the end of buffer " +
                          std::to_string(view.buffer));
  }
  if (offset > view.byte_length) {
    throw Fault(what, "begins past the end of bufferView " + std::to_string(view_index));
  }
  return buffer.subspan(view.byte_offset + offset, view.byte_length - offset);
}

AccessorReader::AccessorReader(const File &file, int accessor_index, Model::ElementType type)
    : accessor_(file.model.accessors[accessor_index]), what_("accessor " + std::to_string(accessor_index))
{
  const std::size_t size = component_size(accessor_.component_type);
  if (size == 0) {
    throw Fault(what_, "componentType " + std::to_string(accessor_.component_type) + " is not one of glTF 2.0");
  }
  const auto [width, name] = name_of(type);
  if (accessor_.type != type) {
    throw Fault(what_, std::string("must be a ") + name);
  }
  element_size_ = size * width;
  stride_ = element_size_;
  if (accessor_.buffer_view >= 0) {
    const std::size_t byte_stride = file.model.buffer_views[accessor_.buffer_view].byte_stride;
    if (byte_stride != 0 && byte_stride < element_size_) {
      throw Fault(what_, "byteStride " + std::to_string(byte_stride) + " is below the size of an element, " +
                             std::to_string(element_size_));
    }
    stride_ = byte_stride == 0 ? element_size_ : byte_stride;
    bytes_ = view_bytes(file, accessor_.buffer_view, accessor_.byte_offset, what_);
    if (!fits(bytes_.size(), accessor_.count, stride_, element_size_)) {
      throw Fault(what_, "runs past the end of bufferView " + std::to_string(accessor_.buffer_view) + ": count is " +
                             std::to_string(accessor_.count));
    }
  }
  else if (accessor_.count > empty_count_max) {
    throw Fault(what_, "count " + std::to_string(accessor_.count) + " is too large for an accessor without bufferView");
  }
  if (accessor_.sparse) {
    read_sparse(file);
  }
}

void AccessorReader::read_sparse(const File &file)
{
  const Model::Sparse &sparse = *accessor_.sparse;
  const std::size_t count = sparse.count;
  if (count > accessor_.count) {
    throw Fault(what_, "sparse.count " + std::to_string(count) + " is above count");
  }
  const std::size_t index_size = component_size(std::uint64_t(sparse.indices.component_type));
  const std::span<const unsigned char> indices =
      view_bytes(file, sparse.indices.buffer_view, sparse.indices.byte_offset, what_);
  sparse_values_ = view_bytes(file, sparse.values.buffer_view, sparse.values.byte_offset, what_);
  if (index_size == 0 || !fits(indices.size(), count, index_size, index_size)) {
    throw Fault(what_, "its sparse indices run past the end of their bufferView");
  }
  if (!fits(sparse_values_.size(), count, element_size_, element_size_)) {
    throw Fault(what_, "its sparse values run past the end of their bufferView");
  }
  sparse_indices_.resize(count);
  for (std::size_t i = 0; i < count; i++) {
    const unsigned char *bytes = indices.data() + i * index_size;
    sparse_indices_[i] = loaded_integer(bytes, index_size);
    if (sparse_indices_[i] >= accessor_.count || (i > 0 && sparse_indices_[i] <= sparse_indices_[i - 1])) {
      throw Fault(what_, "its sparse indices do not ascend, or one is out of range");
    }
  }
}

const unsigned char *AccessorReader::element(std::size_t index) const
{
  if (!sparse_indices_.empty()) {
    const auto found = std::lower_bound(sparse_indices_.begin(), sparse_indices_.end(), index);
    if (found != sparse_indices_.end() && *found == index) {
      return sparse_values_.data() + static_cast<std::size_t>(found - sparse_indices_.begin()) * element_size_;
    }
  }
  return bytes_.empty() ? nullptr : bytes_.data() + index * stride_;
}

float AccessorReader::component(const unsigned char *bytes) const
{
  switch (accessor_.component_type) {
    case Model::Byte: return from_integer<std::int8_t>(bytes, accessor_.is_normalized);
    case Model::UnsignedByte: return from_integer<std::uint8_t>(bytes, accessor_.is_normalized);
    case Model::Short: return from_integer<std::int16_t>(bytes, accessor_.is_normalized);
    case Model::UnsignedShort: return from_integer<std::uint16_t>(bytes, accessor_.is_normalized);
    case Model::UnsignedInt: return from_integer<std::uint32_t>(bytes, accessor_.is_normalized);
    default: return loaded<float>(bytes);
  }
}

glm::vec3 AccessorReader::vec3(std::size_t index) const
{
  const unsigned char *bytes = element(index);
  if (bytes == nullptr) {
    return glm::vec3(0.0F);
  }
  const std::size_t size = element_size_ / 3;
  return {component(bytes), component(bytes + size), component(bytes + 2 * size)};
}

glm::vec2 AccessorReader::vec2(std::size_t index) const
{
  const unsigned char *bytes = element(index);
  if (bytes == nullptr) {
    return glm::vec2(0.0F);
  }
  return {component(bytes), component(bytes + element_size_ / 2)};
}

glm::vec4 AccessorReader::vec4(std::size_t index) const
{
  const unsigned char *bytes = element(index);
  if (bytes == nullptr) {
    return glm::vec4(0.0F);
  }
  const std::size_t size = element_size_ / 4;
  return {component(bytes), component(bytes + size), component(bytes + 2 * size), component(bytes + 3 * size)};
}

float AccessorReader::scalar(std::size_t index) const
{
  const unsigned char *bytes = element(index);
  return bytes == nullptr ? 0.0F : component(bytes);
}

glm::mat4 AccessorReader::mat4(std::size_t index) const
{
  glm::mat4 matrix(0.0F);
  if (const unsigned char *bytes = element(index)) {
    const std::size_t size = element_size_ / 16;
    for (int i = 0; i < 16; i++) {
      matrix[i / 4][i % 4] = component(bytes + std::size_t(i) * size);
    }
  }
  return matrix;
}

glm::vec4 AccessorReader::color(std::size_t index) const
{
  return accessor_.type == Model::ElementType::Vec3 ? glm::vec4(vec3(index), 1.0F) : vec4(index);
}

bool AccessorReader::is_color() const
{
  const bool is_small =
      accessor_.component_type == Model::UnsignedByte || accessor_.component_type == Model::UnsignedShort;
  return accessor_.component_type == Model::Float || (is_small && accessor_.is_normalized);
}

bool AccessorReader::is_unsigned() const
{
  return accessor_.component_type == Model::UnsignedByte || accessor_.component_type == Model::UnsignedShort ||
         accessor_.component_type == Model::UnsignedInt;
}

std::uint32_t AccessorReader::integer(std::size_t index) const
{
  const unsigned char *bytes = element(index);
  return bytes == nullptr ? 0 : loaded_integer(bytes, element_size_);
}

std::array<std::uint32_t, 4> AccessorReader::integers(std::size_t index) const
{
  std::array<std::uint32_t, 4> values{};
  if (const unsigned char *bytes = element(index)) {
    const std::size_t size = element_size_ / 4;
    for (std::size_t i = 0; i < 4; i++) {
      values[i] = loaded_integer(bytes + i * size, size);
    }
  }
  return values;
}

}  // namespace gnomon::gltf
