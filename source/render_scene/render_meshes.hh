// SPDX-License-Identifier: MIT
#pragma once

#include "render_host_resources.hh"

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
 * The meshes of a scene on one device. A mesh is uploaded when it is first drawn, and again after its layout has
 * changed or when a pass reads more of its streams. After other changes of its shape, upload() writes the changed
 * vertices. Shapes in buffers of the host are drawn from these.
 */
class Meshes {
 public:
  /**
   * The triangles of the mesh \a handle on the device, with at least \a streams. The reference is valid until the next
   * get() of this mesh, until the next get() after meshes were added to the scene, or until update().
   * \throws gpu::Error if the device cannot create the batch; the previous batch of the mesh then stays. Also if the
   * batch of the host does not have the streams or the elements of the mesh.
   * \throws scene::StaleHandle
   */
  const gpu::Batch &get(gpu::Device &device, const scene::Scene &scene, scene::Handle<scene::Mesh> handle,
                        MeshStreams streams);
  /** Write the changed vertices of the meshes on the device whose layout is the same. */
  void upload(gpu::Device &device, const scene::Scene &scene);
  /** The batch of a mesh; nullptr if the mesh is not on the device. */
  [[nodiscard]] const gpu::Batch *find(scene::Handle<scene::Mesh> handle) const;
  /** \see RenderScene::set_host_batch */
  [[nodiscard]] HostResources<scene::Mesh, gpu::HostBatch> &host_batches()
  {
    return host_batches_;
  }
  [[nodiscard]] const HostResources<scene::Mesh, gpu::HostBatch> &host_batches() const
  {
    return host_batches_;
  }
  /** Whether the device has, or can be given, the shape of \a mesh. */
  [[nodiscard]] bool has_shape(scene::Handle<scene::Mesh> handle, const scene::Mesh &mesh) const
  {
    return !mesh.host_shape || host_batches_.find(handle);
  }
  /**
   * Apply the changes of the host's batches, and free the batches of meshes that were removed from the scene or are no
   * longer in buffers of the host.
   */
  HostChanges update(const scene::Pool<scene::Mesh> &meshes);
  /**
   * Free the batches that get() replaced by ones with more streams. Passes that were recorded before draw them until
   * then. \return whether there were any, so that passes must be built again
   */
  bool free_outgrown();

 private:
  struct Entry {
    gpu::Batch batch;
    scene::Handle<scene::Mesh> handle;
    /** The shape whose values the batch has. */
    scene::Revision shape = 0;
    /** The shape with which the batch was made. Unless it is empty, it has these values or later ones. */
    scene::Revision made = 0;
    scene::Revision layout = 0;
    /** The number in `host_batches_`; 0: the mesh was uploaded. */
    std::uint64_t host_resource = 0;
    MeshStreams streams = MeshStreams::Shape;
  };
  static void write_changes(gpu::Device &device, const scene::Scene &scene, Entry &entry);

  /** Indexed by Handle::index. */
  std::vector<Entry> entries_;
  /** The latest shape at the last upload(); 0: since a loss, no upload() has written all. */
  scene::Revision uploaded_shape_ = 0;
  /** gpu::Device::loss_count at the last upload(). */
  std::uint64_t loss_count_ = 0;
  /** \see free_outgrown */
  std::vector<gpu::Batch> outgrown_;
  HostResources<scene::Mesh, gpu::HostBatch> host_batches_;
};

}  // namespace gnomon::render_scene
