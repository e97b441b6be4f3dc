// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include "gpu_device.hh"

namespace gnomon::render_scene {

/** The vertex streams that a pass reads. Each value includes the streams of the values before it. */
enum class MeshStreams : std::uint8_t {
  /** Positions and normals. */
  Shape,
  /** Also the first set of uvs. */
  Uvs,
  /** Also the second set of uvs, tangents and colours. Streams that the mesh does not have are 0, and colours white. */
  All
};

/**
 * The meshes of a scene on one device. A mesh is uploaded when it is first drawn, and again after its shape has changed
 * or when a pass reads more of its streams.
 */
class Meshes {
 public:
  /**
   * The triangles of the mesh \a handle on the device, with at least \a streams. The reference is valid until the next
   * get() of this mesh, until the next get() after meshes were added to the scene, or until free_removed().
   * \throws gpu::Error if the device cannot create the batch; the previous batch of the mesh then stays
   * \throws scene::StaleHandle
   */
  const gpu::Batch &get(gpu::Device &device, const scene::Pool<scene::Mesh> &meshes, scene::Handle<scene::Mesh> handle,
                        MeshStreams streams);
  /** The batch of a mesh; nullptr if the mesh is not on the device. */
  [[nodiscard]] const gpu::Batch *find(scene::Handle<scene::Mesh> handle) const;
  /** Free the batches of meshes that were removed from the scene. */
  void free_removed(const scene::Pool<scene::Mesh> &meshes);

 private:
  struct Entry {
    gpu::Batch batch;
    scene::Handle<scene::Mesh> handle;
    scene::Revision shape = 0;
    MeshStreams streams = MeshStreams::Shape;
  };
  /** Indexed by Handle::index. */
  std::vector<Entry> entries_;
};

}  // namespace gnomon::render_scene
