// SPDX-License-Identifier: MIT
#include "draw_objects.hh"

#include "memory_pages.hh"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace gnomon::draw {

namespace {

/** The cofactors of the upper 3x3 of a matrix. */
struct Cofactors {
  glm::dmat3 columns;
  bool is_mirrored;
};

Cofactors cofactors_of(const glm::mat4 &matrix)
{
  const glm::dmat3 m(matrix);
  const glm::dmat3 columns(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  return {columns, glm::dot(columns[2], m[2]) < 0.0};
}

glm::mat3 normal_matrix(const Cofactors &cofactors)
{
  double largest = 0.0;
  for (int column = 0; column < 3; column++) {
    for (int row = 0; row < 3; row++) {
      largest = std::max(largest, std::abs(cofactors.columns[column][row]));
    }
  }
  return glm::mat3(largest > 0.0 ? cofactors.columns * ((cofactors.is_mirrored ? -1.0 : 1.0) / largest)
                                 : cofactors.columns);
}

}  // namespace

glm::mat3 normal_matrix(const glm::mat4 &world_from_object)
{
  return normal_matrix(cofactors_of(world_from_object));
}

bool is_mirrored(const glm::mat4 &world_from_object)
{
  return cofactors_of(world_from_object).is_mirrored;
}

bool is_finite(const glm::mat4 &matrix)
{
  // Without branches, because nearly all matrices are finite.
  int finite_count = 0;
  for (int column = 0; column < 4; column++) {
    for (int row = 0; row < 4; row++) {
      finite_count += int(std::abs(matrix[column][row]) <= std::numeric_limits<float>::max());
    }
  }
  return finite_count == 16;
}

void CullingArrays::clear()
{
  x.clear();
  y.clear();
  z.clear();
  radius.clear();
  reach.clear();
}

void CullingArrays::reserve(std::size_t count)
{
  x.reserve(count);
  y.reserve(count);
  z.reserve(count);
  radius.reserve(count);
  reach.reserve(count);
}

void CullingArrays::add(const CullingVolume &volume)
{
  x.push_back(volume.center_ws.x);
  y.push_back(volume.center_ws.y);
  z.push_back(volume.center_ws.z);
  radius.push_back(volume.radius);
  reach.push_back(culling_reach(volume));
}

void CullingArrays::set(std::size_t index, const CullingVolume &volume)
{
  x[index] = volume.center_ws.x;
  y[index] = volume.center_ws.y;
  z[index] = volume.center_ws.z;
  radius[index] = volume.radius;
  reach[index] = culling_reach(volume);
}

static void check(ObjectIndex index, const glm::mat4 &world_from_object, const CullingVolume &volume)
{
  if (!is_finite(world_from_object)) {
    throw gpu::Error("object {}: its matrix is not finite", index);
  }
  if (std::isnan(volume.center_ws.x + volume.center_ws.y + volume.center_ws.z + volume.radius)) {
    throw gpu::Error("object {}: its culling volume is not a number", index);
  }
}

ObjectBuffer::ObjectBuffer()
{
  add(glm::mat4(1.0F));
}

ObjectIndex ObjectBuffer::next_index()
{
  if (free_count_ == 0) {
    return index_end();
  }
  while (free_bits_[first_free_word_] == 0) {
    first_free_word_++;
  }
  return ObjectIndex(64 * first_free_word_ + std::size_t(std::countr_zero(free_bits_[first_free_word_])));
}

ObjectIndex ObjectBuffer::add(const glm::mat4 &world_from_object, std::uint32_t value, const CullingVolume &volume)
{
  const ObjectIndex index = next_index();
  check(index, world_from_object, volume);
  if (index == index_end()) {
    objects_.emplace_back();
    culling_arrays_.add(volume);
    revisions_.emplace_back();
    mirrored_.emplace_back();
    free_bits_.resize((objects_.size() + 63) / 64);
  }
  else {
    free_bits_[index / 64] &= ~(std::uint64_t(1) << index % 64);
    free_count_--;
  }
  write(index, world_from_object, value, volume);
  structure_revision_ = revision_;
  return index;
}

void ObjectBuffer::reserve(std::size_t count)
{
  objects_.reserve(count);
  culling_arrays_.reserve(count);
  revisions_.reserve(count);
  mirrored_.reserve(count);
  memory::prefer_large_pages(objects_.data(), objects_.capacity() * sizeof(shared::ObjectData));
}

void ObjectBuffer::set(ObjectIndex index, const glm::mat4 &world_from_object, std::uint32_t value,
                       const CullingVolume &volume)
{
  GNOMON_ASSERT(is_live(index), "object {} was removed", index);
  check(index, world_from_object, volume);
  const CullingVolume before = culling_arrays_[index];
  if (objects_[index].world_from_object != world_from_object || objects_[index].value != value ||
      before.center_ws != volume.center_ws || before.radius != volume.radius) {
    write(index, world_from_object, value, volume);
  }
}

void ObjectBuffer::remove(ObjectIndex index)
{
  GNOMON_ASSERT(is_live(index) && index != object_identity, "object {} cannot be removed", index);
  free_bits_[index / 64] |= std::uint64_t(1) << index % 64;
  free_count_++;
  first_free_word_ = std::min(first_free_word_, std::size_t(index / 64));
  revisions_[index] = 0;
  structure_revision_ = ++revision_;
}

void ObjectBuffer::write(ObjectIndex index, const glm::mat4 &world_from_object, std::uint32_t value,
                         const CullingVolume &volume)
{
  const Cofactors cofactors = cofactors_of(world_from_object);
  const glm::mat3 normal = normal_matrix(cofactors);
  shared::ObjectData &object = objects_[index];
  object.world_from_object = world_from_object;
  object.normal_x = normal[0];
  object.index = index;
  object.normal_y = glm::vec4(normal[1], 0.0F);
  object.normal_z = normal[2];
  object.value = value;
  culling_arrays_.set(index, volume);
  mirrored_[index] = cofactors.is_mirrored ? 1 : 0;
  revisions_[index] = ++revision_;
}

void ObjectBuffer::upload(gpu::Device &device)
{
  // Omit removed objects at the end, so that a scene fits again after its number of objects was reduced to the limit.
  ObjectIndex end = index_end();
  while (!is_live(end - 1)) {
    end--;
  }
  const auto bytes = std::as_bytes(std::span(objects_).first(end));
  if (!buffer_ || buffer_.size_bytes() < bytes.size()) {
    // Reserve capacity for more objects, up to the limit of the device: little at first, twice the size where a scene
    // grows.
    const std::size_t limit = device.limits().storage_block_bytes_max;
    const std::size_t reserve = buffer_ ? bytes.size() : std::max(bytes.size() / 8, 16 * sizeof(shared::ObjectData));
    const std::size_t size = std::max(bytes.size(), std::min(bytes.size() + reserve, limit));
    buffer_ = device.create_buffer({"object_block", gpu::BufferKind::Storage, size});
    uploaded_revision_ = 0;
  }
  if (std::exchange(loss_count_, device.loss_count()) != device.loss_count()) {
    uploaded_revision_ = 0;
  }
  if (uploaded_revision_ == revision_) {
    return;
  }
  // Write each run of changed objects at once. Including up to gap_max unchanged objects is cheaper than another write.
  constexpr ObjectIndex gap_max = 16;
  const auto is_changed = [&](ObjectIndex index) { return revisions_[index] > uploaded_revision_; };
  for (ObjectIndex first = 0; first < end; first++) {
    if (!is_changed(first)) {
      continue;
    }
    ObjectIndex last = first;
    for (ObjectIndex i = first + 1; i < end && i - last <= gap_max; i++) {
      last = is_changed(i) ? i : last;
    }
    device.update(buffer_, first * sizeof(shared::ObjectData),
                  bytes.subspan(first * sizeof(shared::ObjectData), (last - first + 1) * sizeof(shared::ObjectData)));
    first = last;
  }
  uploaded_revision_ = revision_;
}

}  // namespace gnomon::draw
