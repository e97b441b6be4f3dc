// SPDX-License-Identifier: MIT
#include "internal/gltf_decompress.hh"

#include <meshoptimizer.h>

#include <string>
#include <utility>

namespace gnomon::gltf {

namespace {

/**
 * Largest ratio of decoded to compressed bytes of valid data: a run of equal vertices takes at least 1 bit for 32 bytes
 * (vertex codec, version 0: 2 bits for each byte of 16 vertices).
 */
constexpr std::uint64_t ratio_max = 64;

std::span<const unsigned char> compressed_bytes(const File &file, const Model::Meshopt &meshopt)
{
  const std::span<const unsigned char> buffer = file.buffers[meshopt.buffer];
  if (meshopt.byte_offset > buffer.size() || meshopt.byte_length > buffer.size() - meshopt.byte_offset) {
    throw Fault("EXT_meshopt_compression", "runs past the end of buffer " + std::to_string(meshopt.buffer));
  }
  return buffer.subspan(meshopt.byte_offset, meshopt.byte_length);
}

/** The conditions of the extension's specification, which meshoptimizer asserts. */
bool is_valid(const Model::Meshopt &meshopt)
{
  const std::uint64_t stride = meshopt.byte_stride;
  if (meshopt.mode == "ATTRIBUTES") {
    const bool is_filter_valid = meshopt.filter == "NONE" || meshopt.filter == "EXPONENTIAL" ||
                                 (meshopt.filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) ||
                                 (meshopt.filter == "QUATERNION" && stride == 8);
    return stride > 0 && stride <= 256 && stride % 4 == 0 && is_filter_valid;
  }
  const bool is_index_mode = meshopt.mode == "INDICES" || (meshopt.mode == "TRIANGLES" && meshopt.count % 3 == 0);
  return is_index_mode && (stride == 2 || stride == 4) && meshopt.filter == "NONE";
}

std::vector<unsigned char> decoded(const File &file, const Model::Meshopt &meshopt)
{
  const std::string what = "EXT_meshopt_compression";
  const std::span<const unsigned char> source = compressed_bytes(file, meshopt);
  if (!is_valid(meshopt)) {
    throw Fault(what, "mode '" + printable(meshopt.mode) + "', filter '" + printable(meshopt.filter) +
                          "', byteStride " + std::to_string(meshopt.byte_stride) + " and count " +
                          std::to_string(meshopt.count) + " do not belong together");
  }
  if (meshopt.count > ratio_max * source.size() / meshopt.byte_stride) {
    throw Fault(what, "count " + std::to_string(meshopt.count) + " is more than " + std::to_string(source.size()) +
                          " bytes can hold");
  }
  const std::size_t count = meshopt.count;
  const std::size_t stride = meshopt.byte_stride;
  std::vector<unsigned char> bytes(count * stride);
  const bool is_vertices = meshopt.mode == "ATTRIBUTES";
  const int error = is_vertices ? meshopt_decodeVertexBuffer(bytes.data(), count, stride, source.data(), source.size())
                    : meshopt.mode == "TRIANGLES"
                        ? meshopt_decodeIndexBuffer(bytes.data(), count, stride, source.data(), source.size())
                        : meshopt_decodeIndexSequence(bytes.data(), count, stride, source.data(), source.size());
  if (error != 0) {
    throw Fault(what, "the data is damaged");
  }
  if (meshopt.filter == "OCTAHEDRAL") {
    meshopt_decodeFilterOct(bytes.data(), count, stride);
  }
  else if (meshopt.filter == "QUATERNION") {
    meshopt_decodeFilterQuat(bytes.data(), count, stride);
  }
  else if (meshopt.filter == "EXPONENTIAL") {
    meshopt_decodeFilterExp(bytes.data(), count, stride);
  }
  return bytes;
}

}  // namespace

void decompress(File &file, Progress &progress, Warnings &warnings)
{
  for (std::size_t i = 0; i < file.model.buffer_views.size(); i++) {
    progress.step();
    Model::BufferView &view = file.model.buffer_views[i];
    if (!view.meshopt) {
      continue;
    }
    try {
      file.storage.push_back(decoded(file, *view.meshopt));
      view.buffer = int(file.buffers.size());
      view.byte_offset = 0;
      view.byte_length = file.storage.back().size();
      file.buffers.emplace_back(file.storage.back());
    }
    catch (const Fault &fault) {
      // The view keeps its fallback buffer, which may have uncompressed data.
      warnings.add_counted("bufferView " + std::to_string(i), 1, fault.what());
    }
  }
  decompress_draco(file, progress, warnings);
}

}  // namespace gnomon::gltf
