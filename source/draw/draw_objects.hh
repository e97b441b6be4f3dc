// SPDX-License-Identifier: MIT
#pragma once

#include "draw_view.hh"

#include "gpu_device.hh"

#include "draw_object_shared.h"

#include <glm/mat4x4.hpp>

#include <vector>

namespace gnomon::draw {

/** Index of an object in `object_block`; a call hands it to the vertex shader. */
using ObjectIndex = std::uint32_t;

/** The identity matrix; calls without a matrix of their own use it. */
inline constexpr ObjectIndex object_identity = 0;

/**
 * The objects of one scene on one device: matrices, culling volumes and one value each. `object_block` in GLSL.
 *
 * An object keeps its index until it is removed. Revisions tell what changed: a viewport hands an engine only the
 * objects that changed since the engine's last sync. Passes read volumes when they are recorded, so that a moved object
 * needs no pass to be rebuilt.
 */
class ObjectBuffer {
 public:
  ObjectBuffer();

  /**
   * \a value is for the engine's shaders to interpret; eevee's is the index of the material.
   * \throws gpu::Error where the matrix is not finite, or the volume is not a number; nothing changes then.
   */
  ObjectIndex add(const glm::mat4 &world_from_object, std::uint32_t value = 0, const CullingVolume &volume = {});
  /** Change an object. The same values again change nothing. \pre \a index is of add, and not removed \throws as add */
  void set(ObjectIndex index, const glm::mat4 &world_from_object, std::uint32_t value, const CullingVolume &volume);
  /** Its index may be used again by add, which takes the least free one. \pre as set */
  void remove(ObjectIndex index);

  [[nodiscard]] const glm::mat4 &world_from_object(ObjectIndex index) const
  {
    return objects_[index].world_from_object;
  }
  [[nodiscard]] const CullingVolume &volume(ObjectIndex index) const
  {
    return volumes_[index];
  }
  [[nodiscard]] bool is_live(ObjectIndex index) const
  {
    return index < revisions_.size() && revisions_[index] != 0;
  }
  /** The edit that changed the object last; 0: it was removed. */
  [[nodiscard]] std::uint64_t revision(ObjectIndex index) const
  {
    return revisions_[index];
  }
  /** The last edit of any object. */
  [[nodiscard]] std::uint64_t revision() const
  {
    return revision_;
  }
  /** The last edit that added or removed an object. */
  [[nodiscard]] std::uint64_t structure_revision() const
  {
    return structure_revision_;
  }
  /** Above every index in use. */
  [[nodiscard]] ObjectIndex index_end() const
  {
    return ObjectIndex(objects_.size());
  }
  /** Objects, the identity among them. */
  [[nodiscard]] std::size_t size() const
  {
    return objects_.size() - free_.size();
  }

  /** Write what changed since the last upload to the device. \throws gpu::Error past the limit of a storage block. */
  void upload(gpu::Device &device);
  /** Valid after upload. */
  [[nodiscard]] const gpu::Buffer &buffer() const
  {
    return buffer_;
  }

 private:
  void write(ObjectIndex index, const glm::mat4 &world_from_object, std::uint32_t value, const CullingVolume &volume);

  std::vector<shared::ObjectData> objects_;
  std::vector<CullingVolume> volumes_;
  std::vector<std::uint64_t> revisions_;
  /** A heap with the least index first, so that indices, and with them the order of drawing, depend on few edits. */
  std::vector<ObjectIndex> free_;
  std::uint64_t revision_ = 0;
  std::uint64_t structure_revision_ = 0;
  /** Of the last upload. */
  std::uint64_t uploaded_revision_ = 0;
  /** gpu::Device::loss_count then. */
  std::uint64_t loss_count_ = 0;
  gpu::Buffer buffer_;
};

/**
 * Columns of the matrix that takes object-space normals to world space, up to scale: the cofactors of the
 * upper 3x3, which exist for singular matrices too, and keep normals on the outside of mirrored objects.
 * The largest element is 1 unless all are 0.
 */
[[nodiscard]] glm::mat3 normal_matrix(const glm::mat4 &world_from_object);

/** Whether the matrix turns front faces inside out: its determinant is negative. */
[[nodiscard]] bool is_mirrored(const glm::mat4 &world_from_object);

/** Whether all elements are finite. */
[[nodiscard]] bool is_finite(const glm::mat4 &matrix);

}  // namespace gnomon::draw
