// SPDX-License-Identifier: MIT
#include "internal/gltf_accessor.hh"

#include "internal/gltf_report.hh"

#include <algorithm>
#include <cstring>
#include <limits>

namespace gnomon::gltf {

namespace {

/** An accessor without bytes of its own costs a file nothing, so its count needs a limit of ours. */
constexpr std::size_t empty_count_max = std::size_t(1) << 24U;

std::size_t component_size(int component_type)
{
  switch (component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT: return 4;
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

/** How many components an element has. */
std::size_t width_of(int type)
{
  return type == TINYGLTF_TYPE_SCALAR ? 1 : type == TINYGLTF_TYPE_VEC2 ? 2 : 3;
}

}  // namespace

std::span<const unsigned char> view_bytes(const File &file, int view_index, std::size_t offset, const std::string &what)
{
  const tinygltf::BufferView &view = file.model.bufferViews[view_index];
  const std::span<const unsigned char> buffer = file.buffers[view.buffer];
  if (buffer.empty()) {
    throw Fault(what, "buffer " + std::to_string(view.buffer) + " holds no data");
  }
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset) {
    throw Fault(what, "bufferView " + std::to_string(view_index) + " runs past the end of buffer " +
                          std::to_string(view.buffer));
  }
  if (offset > view.byteLength) {
    throw Fault(what, "begins past the end of bufferView " + std::to_string(view_index));
  }
  return buffer.subspan(view.byteOffset + offset, view.byteLength - offset);
}

AccessorReader::AccessorReader(const File &file, int accessor_index, int type)
    : accessor_(file.model.accessors[accessor_index]), what_("accessor " + std::to_string(accessor_index))
{
  const std::size_t size = component_size(accessor_.componentType);
  if (size == 0) {
    throw Fault(what_, "componentType " + std::to_string(accessor_.componentType) + " is not one of glTF 2.0");
  }
  if (accessor_.type != type) {
    throw Fault(what_, type == TINYGLTF_TYPE_SCALAR ? "must be a SCALAR"
                       : type == TINYGLTF_TYPE_VEC2 ? "must be a VEC2"
                                                    : "must be a VEC3");
  }
  element_size_ = size * width_of(type);
  stride_ = element_size_;
  if (accessor_.bufferView >= 0) {
    const std::size_t byte_stride = file.model.bufferViews[accessor_.bufferView].byteStride;
    if (byte_stride != 0 && byte_stride < element_size_) {
      throw Fault(what_, "byteStride " + std::to_string(byte_stride) + " is below the size of an element, " +
                             std::to_string(element_size_));
    }
    stride_ = byte_stride == 0 ? element_size_ : byte_stride;
    bytes_ = view_bytes(file, accessor_.bufferView, accessor_.byteOffset, what_);
    if (!fits(bytes_.size(), accessor_.count, stride_, element_size_)) {
      throw Fault(what_, "runs past the end of bufferView " + std::to_string(accessor_.bufferView) + ": count is " +
                             std::to_string(accessor_.count));
    }
  }
  else if (accessor_.count > empty_count_max) {
    throw Fault(what_, "count " + std::to_string(accessor_.count) + " is too large for an accessor without bufferView");
  }
  if (accessor_.sparse.isSparse) {
    read_sparse(file);
  }
}

void AccessorReader::read_sparse(const File &file)
{
  const auto &sparse = accessor_.sparse;
  const auto count = static_cast<std::size_t>(sparse.count);
  if (count > accessor_.count) {
    throw Fault(what_, "sparse.count " + std::to_string(count) + " is above count");
  }
  const std::size_t index_size = component_size(sparse.indices.componentType);
  const std::span<const unsigned char> indices =
      view_bytes(file, sparse.indices.bufferView, sparse.indices.byteOffset, what_);
  sparse_values_ = view_bytes(file, sparse.values.bufferView, sparse.values.byteOffset, what_);
  if (index_size == 0 || !fits(indices.size(), count, index_size, index_size)) {
    throw Fault(what_, "its sparse indices run past the end of their bufferView");
  }
  if (!fits(sparse_values_.size(), count, element_size_, element_size_)) {
    throw Fault(what_, "its sparse values run past the end of their bufferView");
  }
  sparse_indices_.resize(count);
  for (std::size_t i = 0; i < count; i++) {
    const unsigned char *bytes = indices.data() + i * index_size;
    sparse_indices_[i] = index_size == 1   ? loaded<std::uint8_t>(bytes)
                         : index_size == 2 ? loaded<std::uint16_t>(bytes)
                                           : loaded<std::uint32_t>(bytes);
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
  switch (accessor_.componentType) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: return from_integer<std::int8_t>(bytes, accessor_.normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: return from_integer<std::uint8_t>(bytes, accessor_.normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT: return from_integer<std::int16_t>(bytes, accessor_.normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: return from_integer<std::uint16_t>(bytes, accessor_.normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT: return from_integer<std::uint32_t>(bytes, accessor_.normalized);
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

bool AccessorReader::is_unsigned() const
{
  return accessor_.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
         accessor_.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
         accessor_.componentType == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

std::uint32_t AccessorReader::integer(std::size_t index) const
{
  const unsigned char *bytes = element(index);
  if (bytes == nullptr) {
    return 0;
  }
  switch (element_size_) {
    case 1: return loaded<std::uint8_t>(bytes);
    case 2: return loaded<std::uint16_t>(bytes);
    default: return loaded<std::uint32_t>(bytes);
  }
}

}  // namespace gnomon::gltf
