// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_device.hh"

#include "draw_object_shared.h"

#include <glm/mat4x4.hpp>

#include <vector>

namespace gnomon::draw {

/** Index of an object in `object_block`; what a call hands to the vertex shader. */
using ObjectIndex = std::uint32_t;

/** The identity matrix; what calls without a matrix of their own use. */
inline constexpr ObjectIndex object_identity = 0;

/** The matrices of everything that is drawn, shared by all passes of a viewport: `object_block` in GLSL. */
class ObjectBuffer {
 public:
  ObjectBuffer();

  /** \a value is the engine's to interpret, eevee's material index for one. */
  ObjectIndex add(const glm::mat4 &world_from_object, std::uint32_t value = 0);
  /** Back to the identity alone. */
  void clear();
  /** Bring the device's copy up to date; free where nothing was added since. \throws gpu::Error past the limit. */
  void upload(gpu::Device &device);

  /** Valid after upload. */
  [[nodiscard]] const gpu::Buffer &buffer() const
  {
    return buffer_;
  }
  [[nodiscard]] std::size_t size() const
  {
    return objects_.size();
  }

 private:
  std::vector<shared::ObjectData> objects_;
  gpu::Buffer buffer_;
  bool is_dirty_ = true;
};

/**
 * Columns of the matrix that takes object-space normals to world space, up to scale: the cofactors of the
 * upper 3x3, which exist for singular matrices too, and keep normals on the outside of mirrored objects.
 * The largest element is 1 unless all are 0.
 */
[[nodiscard]] glm::mat3 normal_matrix(const glm::mat4 &world_from_object);

/** Whether the matrix turns front faces inside out: its determinant is negative. */
[[nodiscard]] bool is_mirrored(const glm::mat4 &world_from_object);

}  // namespace gnomon::draw
