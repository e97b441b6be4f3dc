// SPDX-License-Identifier: MIT
#pragma once

#include "scene.hh"

#include "gpu_device.hh"

namespace gnomon::render_scene {

/** What a pass reads of a mesh's vertices. Each includes those before it. */
enum class MeshStreams : std::uint8_t {
  /** Positions and normals. */
  Shape,
  /** Mesh::uvs. */
  Uvs,
  /** Both sets of uvs, tangents and colours. Those that the mesh does not have are 0, and colours white. */
  All
};

/** The meshes of a scene on one device. A mesh is uploaded when it is first drawn, and again when its shape changes. */
class Meshes {
 public:
  /**
   * \a handle's triangles on the device, with \a streams at least. The reference holds until the next call with the
   * same handle, or until free_removed. \throws gpu::Error where the device cannot hold it; what was there before
   * stays then. \throws scene::StaleHandle
   */
  const gpu::Batch &get(gpu::Device &device, const scene::Pool<scene::Mesh> &meshes, scene::Handle<scene::Mesh> handle,
                        MeshStreams streams);
  /** The batch of a mesh; nullptr: it is not on the device. */
  [[nodiscard]] const gpu::Batch *find(scene::Handle<scene::Mesh> handle) const;
  /** Free the batches of meshes that were removed. */
  void free_removed(const scene::Pool<scene::Mesh> &meshes);

 private:
  struct Entry {
    gpu::Batch batch;
    scene::Handle<scene::Mesh> handle;
    scene::Revision shape = 0;
    MeshStreams streams = MeshStreams::Shape;
  };
  /** By Handle::index. */
  std::vector<Entry> entries_;
};

}  // namespace gnomon::render_scene
