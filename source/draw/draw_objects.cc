// SPDX-License-Identifier: MIT
#include "draw_objects.hh"

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace gnomon::draw {

glm::mat3 normal_matrix(const glm::mat4 &world_from_object)
{
  const glm::dmat3 m(world_from_object);
  glm::dmat3 cofactors(glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1]));
  double largest = 0.0;
  for (int column = 0; column < 3; column++) {
    for (int row = 0; row < 3; row++) {
      largest = std::max(largest, std::abs(cofactors[column][row]));
    }
  }
  if (largest > 0.0) {
    cofactors *= (is_mirrored(world_from_object) ? -1.0 : 1.0) / largest;
  }
  return glm::mat3(cofactors);
}

bool is_mirrored(const glm::mat4 &world_from_object)
{
  const glm::dmat3 m(world_from_object);
  return glm::dot(glm::cross(m[0], m[1]), m[2]) < 0.0;
}

ObjectBuffer::ObjectBuffer()
{
  clear();
}

ObjectIndex ObjectBuffer::add(const glm::mat4 &world_from_object, std::uint32_t value)
{
  const glm::mat3 normal = normal_matrix(world_from_object);
  shared::ObjectData object{};
  object.world_from_object = world_from_object;
  object.normal_x = glm::vec4(normal[0], 0.0F);
  object.normal_y = glm::vec4(normal[1], 0.0F);
  object.normal_z = normal[2];
  object.value = value;
  objects_.push_back(object);
  is_dirty_ = true;
  return ObjectIndex(objects_.size() - 1);
}

void ObjectBuffer::clear()
{
  objects_.clear();
  add(glm::mat4(1.0F));
}

void ObjectBuffer::upload(gpu::Device &device)
{
  const auto bytes = std::as_bytes(std::span(objects_));
  if (!buffer_ || buffer_.size_bytes() < bytes.size()) {
    // Room to grow, as far as the device goes.
    const std::size_t limit = device.limits().storage_block_bytes_max;
    const std::size_t size = std::max(bytes.size(), std::min(std::bit_ceil(bytes.size()), limit));
    buffer_ = device.create_buffer({"object_block", gpu::BufferKind::Storage, size});
    is_dirty_ = true;
  }
  if (std::exchange(is_dirty_, false)) {
    device.update(buffer_, 0, bytes);
  }
}

}  // namespace gnomon::draw
