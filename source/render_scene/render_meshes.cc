// SPDX-License-Identifier: MIT
#include "render_meshes.hh"

namespace gnomon::render_scene {

const gpu::Batch &Meshes::get(gpu::Device &device, const scene::Pool<scene::Mesh> &meshes,
                              scene::Handle<scene::Mesh> handle, bool needs_uvs)
{
  const scene::Mesh &mesh = meshes[handle];
  const scene::Revision shape = meshes.revision(handle, scene::Mesh::Aspect::Shape);
  if (entries_.size() <= handle.index) {
    entries_.resize(meshes.index_end());
  }
  Entry &entry = entries_[handle.index];
  const bool is_same = entry.batch && entry.handle == handle && entry.shape == shape;
  if (!is_same || (needs_uvs && !entry.has_uvs)) {
    // Once it has texture coordinates it keeps them: another viewport may read them.
    const bool has_uvs = needs_uvs || (is_same && entry.has_uvs);
    gpu::Batch batch = device.create_batch({mesh.name, mesh.positions, mesh.normals, mesh.indices,
                                            has_uvs ? std::span(mesh.uvs) : std::span<const glm::vec2>()});
    entry = {std::move(batch), handle, shape, has_uvs};
  }
  return entry.batch;
}

const gpu::Batch *Meshes::find(scene::Handle<scene::Mesh> handle) const
{
  const bool is_made =
      handle.index < entries_.size() && entries_[handle.index].handle == handle && entries_[handle.index].batch;
  return is_made ? &entries_[handle.index].batch : nullptr;
}

void Meshes::free_removed(const scene::Pool<scene::Mesh> &meshes)
{
  for (Entry &entry : entries_) {
    if (entry.batch && !meshes.is_live(entry.handle)) {
      entry = {};
    }
  }
}

}  // namespace gnomon::render_scene
