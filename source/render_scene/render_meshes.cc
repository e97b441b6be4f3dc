// SPDX-License-Identifier: MIT
#include "render_meshes.hh"

#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <span>
#include <utility>

namespace gnomon::render_scene {

namespace {

template <typename Packed>
std::vector<Packed> packed(std::span<const glm::vec4> values, std::size_t count, Packed absent,
                           Packed (*pack)(const glm::vec4 &))
{
  std::vector<Packed> result(values.empty() ? count : 0, absent);
  std::ranges::transform(values, std::back_inserter(result), pack);
  return result;
}

/**
 * Call \a use with the streams of \a range, as they are on the device, without indices. \a has_absent: also with those
 * of \a streams that the mesh does not have. Their values never change.
 */
template <typename Use>
void use_streams(const scene::Mesh &mesh, MeshStreams streams, bool has_absent, scene::VertexRange range, Use &&use)
{
  const auto part = [&](const auto &stream) {
    return std::span(stream).subspan(stream.empty() ? 0 : range.first, stream.empty() ? 0 : range.count);
  };
  gpu::BatchDesc desc{mesh.name, part(mesh.positions), part(mesh.normals), {}};
  if (streams >= MeshStreams::Uvs) {
    desc.uvs = part(mesh.uvs);
  }
  if (streams < MeshStreams::All) {
    use(desc);
    return;
  }
  const std::size_t absent_count = has_absent ? range.count : 0;
  const std::vector<glm::vec2> zeros(mesh.uvs.empty() || mesh.second_uvs.empty() ? absent_count : 0, glm::vec2(0.0F));
  desc.uvs = mesh.uvs.empty() ? zeros : part(mesh.uvs);
  desc.second_uvs = mesh.second_uvs.empty() ? zeros : part(mesh.second_uvs);
  const auto tangents =
      packed<glm::i16vec4>(part(mesh.tangents), absent_count, glm::i16vec4(0),
                           [](const glm::vec4 &tangent) { return glm::packSnorm<glm::int16>(tangent); });
  const auto colors = packed<glm::u16vec4>(part(mesh.colors), absent_count, glm::u16vec4(65535),
                                           [](const glm::vec4 &color) { return glm::packUnorm<glm::uint16>(color); });
  desc.tangents = tangents;
  desc.colors = colors;
  use(desc);
}

gpu::Batch make_batch(gpu::Device &device, const scene::Mesh &mesh, MeshStreams streams)
{
  gpu::Batch batch;
  use_streams(mesh, streams, true, {0, std::uint32_t(mesh.positions.size())}, [&](gpu::BatchDesc &desc) {
    desc.indices = mesh.indices;
    batch = device.create_batch(desc);
  });
  return batch;
}

gpu::Batch make_host_batch(gpu::Device &device, const scene::Mesh &mesh, const gpu::HostBatch &batch)
{
  const auto check_stream = [&](bool is_needed, gpu::VertexStream stream) {
    if (is_needed && batch.stream(stream).buffer == 0) {
      throw gpu::Error("mesh '{}': its shape has {}, and the host's batch has none", mesh.name, to_string(stream));
    }
  };
  check_stream(true, gpu::VertexStream::Normal);
  check_stream(mesh.has_uvs(0), gpu::VertexStream::Uv);
  check_stream(mesh.has_uvs(1), gpu::VertexStream::SecondUv);
  check_stream(mesh.has_tangents(), gpu::VertexStream::Tangent);
  check_stream(mesh.has_colors(), gpu::VertexStream::Color);
  if (batch.index_count % index_count_of(mesh.topology) != 0) {
    throw gpu::Error("mesh '{}': the {} indices of the host's batch are no multiple of {}", mesh.name,
                     batch.index_count, index_count_of(mesh.topology));
  }
  return device.create_batch(mesh.name, batch);
}

}  // namespace

void Meshes::write_changes(gpu::Device &device, const scene::Scene &scene, Entry &entry)
{
  const scene::Revision shape = scene.meshes().revision(entry.handle, scene::Mesh::Aspect::Shape);
  if (entry.shape == shape) {
    return;
  }
  for (const scene::VertexRange range : scene.changed_vertices(entry.handle, entry.shape)) {
    use_streams(scene.meshes()[entry.handle], entry.streams, false, range,
                [&](const gpu::BatchDesc &values) { device.update(entry.batch, range.first, values); });
  }
  entry.shape = shape;
}

void Meshes::upload(gpu::Device &device, const scene::Scene &scene)
{
  using enum scene::Mesh::Aspect;
  const scene::Pool<scene::Mesh> &meshes = scene.meshes();
  if (std::exchange(loss_count_, device.loss_count()) != device.loss_count()) {
    // All changes since a batch was made may be lost. They stay to be written if this call fails.
    for (Entry &entry : entries_) {
      entry.shape = entry.made;
    }
    uploaded_shape_ = 0;
  }
  if (uploaded_shape_ == meshes.latest(Shape)) {
    return;
  }
  for (Entry &entry : entries_) {
    if (entry.batch && entry.host_resource == 0 && meshes.is_live(entry.handle) &&
        entry.layout == meshes.revision(entry.handle, Layout)) {
      write_changes(device, scene, entry);
    }
  }
  uploaded_shape_ = meshes.latest(Shape);
}

const gpu::Batch &Meshes::get(gpu::Device &device, const scene::Scene &scene, scene::Handle<scene::Mesh> handle,
                              MeshStreams streams)
{
  const scene::Pool<scene::Mesh> &meshes = scene.meshes();
  const scene::Mesh &mesh = meshes[handle];
  const scene::Revision shape = meshes.revision(handle, scene::Mesh::Aspect::Shape);
  const scene::Revision layout = meshes.revision(handle, scene::Mesh::Aspect::Layout);
  if (entries_.size() <= handle.index) {
    entries_.resize(meshes.index_end());
  }
  Entry &entry = entries_[handle.index];
  const bool is_same = entry.batch && entry.handle == handle && entry.layout == layout;
  if (mesh.host_shape) {
    const gpu::HostBatch *host = host_batches_.find(handle);
    GNOMON_ASSERT(host, "mesh '{}': the host has named no buffers of it", mesh.name);
    const std::uint64_t resource = host_batches_.resource_revision(handle);
    if (!is_same || entry.host_resource != resource) {
      entry = {make_host_batch(device, mesh, *host), handle, shape, shape, layout, resource, MeshStreams::All};
    }
  }
  else if (!is_same || streams > entry.streams) {
    // Keep the streams that were uploaded before, because other viewports may read them.
    const MeshStreams all = is_same ? std::max(streams, entry.streams) : streams;
    gpu::Batch batch = make_batch(device, mesh, all);
    if (is_same) {
      outgrown_.push_back(std::move(entry.batch));
    }
    entry = {std::move(batch), handle, shape, shape, layout, 0, all};
  }
  else {
    write_changes(device, scene, entry);
  }
  return entry.batch;
}

const gpu::Batch *Meshes::find(scene::Handle<scene::Mesh> handle) const
{
  const bool is_made =
      handle.index < entries_.size() && entries_[handle.index].handle == handle && entries_[handle.index].batch;
  return is_made ? &entries_[handle.index].batch : nullptr;
}

bool Meshes::free_outgrown()
{
  return !std::exchange(outgrown_, {}).empty();
}

HostChanges Meshes::update(const scene::Pool<scene::Mesh> &meshes)
{
  const HostChanges changes = host_batches_.update([&](scene::Handle<scene::Mesh> handle) {
    const scene::Mesh *mesh = meshes.find(handle);
    return mesh && mesh->host_shape;
  });
  for (Entry &entry : entries_) {
    if (entry.batch &&
        (!meshes.is_live(entry.handle) || (entry.host_resource != 0 && !host_batches_.find(entry.handle)))) {
      entry = {};
    }
  }
  return changes;
}

}  // namespace gnomon::render_scene
