// SPDX-License-Identifier: MIT
#pragma once

#include "draw_view.hh"

#include "gpu_device.hh"

#include "draw_object_shared.h"

#include <glm/mat4x4.hpp>

#include <cstddef>
#include <vector>

namespace gnomon::draw {

/** Index of an object with the identity matrix, which always exists. */
inline constexpr ObjectIndex object_identity = 0;

/** Culling volumes as a structure of arrays, for tests of several at once. \see View::culling_planes */
struct CullingArrays {
  std::vector<float> x;
  std::vector<float> y;
  std::vector<float> z;
  std::vector<float> radius;
  /** \see culling_reach */
  std::vector<float> reach;

  [[nodiscard]] std::size_t size() const
  {
    return x.size();
  }
  /** \pre index < size() */
  [[nodiscard]] CullingVolume operator[](std::size_t index) const
  {
    return {{x[index], y[index], z[index]}, radius[index]};
  }
  void clear();
  void reserve(std::size_t count);
  void add(const CullingVolume &volume);
  /** \pre index < size() */
  void set(std::size_t index, const CullingVolume &volume);
};

/**
 * The objects of one scene on one device. Each object has a matrix, a culling volume and a value. `object_block` in
 * GLSL.
 *
 * An object keeps its index until it is removed. Viewport::sync uses the revisions to pass only changed objects to an
 * engine. Pass::record reads the culling volumes, so passes need not be rebuilt when an object moves.
 */
class ObjectBuffer {
 public:
  ObjectBuffer();

  /**
   * Add an object. \a value: the engine's shaders define its meaning; for eevee it is the index of the material.
   * \throws gpu::Error if the matrix is not finite or the volume contains NaN; nothing changes then
   */
  ObjectIndex add(const glm::mat4 &world_from_object, std::uint32_t value = 0, const CullingVolume &volume = {});
  /** Make room for \a count objects, in large pages if they are many. */
  void reserve(std::size_t count);
  /**
   * Change an object. The revision increases only if a value differs. \pre is_live(index)
   * \throws gpu::Error under the same conditions as add
   */
  void set(ObjectIndex index, const glm::mat4 &world_from_object, std::uint32_t value, const CullingVolume &volume);
  /** Remove an object. add() reuses the lowest free index. \pre is_live(index), and not object_identity */
  void remove(ObjectIndex index);

  [[nodiscard]] const glm::mat4 &world_from_object(ObjectIndex index) const
  {
    return objects_[index].world_from_object;
  }
  /** \see draw::is_mirrored */
  [[nodiscard]] bool is_mirrored(ObjectIndex index) const
  {
    return mirrored_[index] != 0;
  }
  [[nodiscard]] CullingVolume volume(ObjectIndex index) const
  {
    return culling_arrays_[index];
  }
  /** The volumes of all objects, by index. A free index holds the volume of the object that was removed from it. */
  [[nodiscard]] const CullingArrays &culling_arrays() const
  {
    return culling_arrays_;
  }
  [[nodiscard]] bool is_live(ObjectIndex index) const
  {
    return index < revisions_.size() && revisions_[index] != 0;
  }
  /** Value of revision() after the last edit of this object; 0: the object was removed. */
  [[nodiscard]] std::uint64_t revision(ObjectIndex index) const
  {
    return revisions_[index];
  }
  /** Increases with each edit of an object. */
  [[nodiscard]] std::uint64_t revision() const
  {
    return revision_;
  }
  /** Value of revision() after the last edit that added or removed an object. */
  [[nodiscard]] std::uint64_t structure_revision() const
  {
    return structure_revision_;
  }
  /** Greater than all indices in use. */
  [[nodiscard]] ObjectIndex index_end() const
  {
    return ObjectIndex(objects_.size());
  }
  /** Number of live objects, including object_identity. */
  [[nodiscard]] std::size_t size() const
  {
    return objects_.size() - free_count_;
  }

  /** Write the objects that have changed since the last upload. \throws gpu::Error if they exceed a storage block */
  void upload(gpu::Device &device);
  /** The buffer of `object_block`. Valid after upload(). */
  [[nodiscard]] const gpu::Buffer &buffer() const
  {
    return buffer_;
  }

 private:
  /** The lowest free index, or index_end(). */
  [[nodiscard]] ObjectIndex next_index();
  void write(ObjectIndex index, const glm::mat4 &world_from_object, std::uint32_t value, const CullingVolume &volume);

  std::vector<shared::ObjectData> objects_;
  CullingArrays culling_arrays_;
  std::vector<std::uint64_t> revisions_;
  /** 1 if the matrix is mirrored, otherwise 0. Passes that are recorded need no more of the matrices. */
  std::vector<std::uint8_t> mirrored_;
  /** One bit an index: 1 if it is free. The lowest is used first, so that indices and drawing order depend on few
   * edits. */
  std::vector<std::uint64_t> free_bits_;
  std::size_t free_count_ = 0;
  /** All elements of free_bits_ before this one are 0. */
  std::size_t first_free_word_ = 0;
  std::uint64_t revision_ = 0;
  std::uint64_t structure_revision_ = 0;
  /** revision() at the last upload. */
  std::uint64_t uploaded_revision_ = 0;
  /** gpu::Device::loss_count at the last upload. */
  std::uint64_t loss_count_ = 0;
  gpu::Buffer buffer_;
};

/**
 * The matrix that transforms normals from object space to world space, up to a positive factor. It is the cofactor
 * matrix of the upper 3x3, which also exists for singular matrices, negated for mirroring matrices so that normals keep
 * pointing outwards. The largest magnitude of its elements is 1, unless all are 0.
 */
[[nodiscard]] glm::mat3 normal_matrix(const glm::mat4 &world_from_object);

/** Whether the matrix reverses the winding of faces, that is, its determinant is negative. */
[[nodiscard]] bool is_mirrored(const glm::mat4 &world_from_object);

/** Whether all elements are finite. */
[[nodiscard]] bool is_finite(const glm::mat4 &matrix);

}  // namespace gnomon::draw
