// SPDX-License-Identifier: MIT
#include "internal/gltf_accessor.hh"
#include "internal/gltf_decompress.hh"

#include <draco/compression/decode.h>

#include <cstring>
#include <map>
#include <memory>
#include <tuple>
#include <utility>

namespace gnomon::gltf {

namespace {

using Attributes = std::map<std::string, int, std::less<>>;

std::unique_ptr<draco::Mesh> decoded(const File &file, const Model::Draco &draco)
{
  const std::span<const unsigned char> bytes = view_bytes(file, draco.buffer_view, 0, "KHR_draco_mesh_compression");
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char *>(bytes.data()), bytes.size());
  draco::Decoder decoder;
  auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
  if (!mesh.ok()) {
    throw Fault("KHR_draco_mesh_compression", printable(mesh.status().error_msg_string()));
  }
  return std::move(mesh).value();
}

template <typename T>
bool write_as(const draco::PointAttribute &attribute, const draco::Mesh &mesh, int width,
              std::vector<unsigned char> &to)
{
  const std::size_t element_size = std::size_t(width) * sizeof(T);
  to.resize(mesh.num_points() * element_size);
  for (draco::PointIndex point(0); point < mesh.num_points(); ++point) {
    T values[4] = {};
    if (!attribute.ConvertValue<T>(attribute.mapped_index(point), std::int8_t(width), values)) {
      return false;
    }
    std::memcpy(to.data() + point.value() * element_size, values, element_size);
  }
  return true;
}

/** The values of an attribute in the accessor's type, one for each point of the mesh. */
std::vector<unsigned char> element_bytes(const draco::Mesh &mesh, const std::string &name, int id,
                                         const Model::Accessor &accessor)
{
  const draco::PointAttribute *attribute = mesh.GetAttributeByUniqueId(std::uint32_t(id));
  if (attribute == nullptr) {
    throw Fault(name, "is missing in the compressed mesh");
  }
  const int width = accessor.type == Model::ElementType::Scalar ? 1
                    : accessor.type == Model::ElementType::Vec2 ? 2
                    : accessor.type == Model::ElementType::Vec3 ? 3
                                                                : 4;
  if (accessor.type == Model::ElementType::Matrix || attribute->num_components() != width) {
    throw Fault(name, "has other components in the compressed mesh than in its accessor");
  }
  if (accessor.count != mesh.num_points()) {
    throw Fault(name, "count is " + std::to_string(accessor.count) + ", and the compressed mesh has " +
                          std::to_string(mesh.num_points()) + " vertices");
  }
  std::vector<unsigned char> bytes;
  bool is_converted = false;
  switch (accessor.component_type) {
    case Model::Byte: is_converted = write_as<std::int8_t>(*attribute, mesh, width, bytes); break;
    case Model::UnsignedByte: is_converted = write_as<std::uint8_t>(*attribute, mesh, width, bytes); break;
    case Model::Short: is_converted = write_as<std::int16_t>(*attribute, mesh, width, bytes); break;
    case Model::UnsignedShort: is_converted = write_as<std::uint16_t>(*attribute, mesh, width, bytes); break;
    case Model::UnsignedInt: is_converted = write_as<std::uint32_t>(*attribute, mesh, width, bytes); break;
    case Model::Float: is_converted = write_as<float>(*attribute, mesh, width, bytes); break;
    default: break;
  }
  if (!is_converted) {
    throw Fault(name, "has values in the compressed mesh that its accessor's componentType cannot hold");
  }
  return bytes;
}

std::vector<unsigned char> index_bytes(const draco::Mesh &mesh)
{
  std::vector<std::uint32_t> indices;
  indices.reserve(3 * std::size_t(mesh.num_faces()));
  for (draco::FaceIndex face(0); face < mesh.num_faces(); ++face) {
    for (const draco::PointIndex &point : mesh.face(face)) {
      indices.push_back(point.value());
    }
  }
  std::vector<unsigned char> bytes(indices.size() * sizeof(std::uint32_t));
  std::memcpy(bytes.data(), indices.data(), bytes.size());
  return bytes;
}

/** Adds an uncompressed buffer, view and accessor. \return the accessor's index. */
int add_accessor(File &file, std::vector<unsigned char> bytes, Model::Accessor accessor)
{
  file.storage.push_back(std::move(bytes));
  Model::BufferView view;
  view.buffer = int(file.buffers.size());
  view.byte_length = file.storage.back().size();
  file.buffers.emplace_back(file.storage.back());
  accessor.buffer_view = int(file.model.buffer_views.size());
  accessor.byte_offset = 0;
  accessor.sparse.reset();
  file.model.buffer_views.push_back(std::move(view));
  file.model.accessors.push_back(std::move(accessor));
  return int(file.model.accessors.size()) - 1;
}

/** Accessors of a decoded primitive. */
struct Plain {
  Attributes attributes;
  int indices = -1;
};

Plain plain_of(File &file, const Model::Primitive &primitive)
{
  const std::unique_ptr<draco::Mesh> mesh = decoded(file, *primitive.draco);
  // Decode everything before adding anything, so that a fault leaves the file unchanged.
  std::map<std::string, std::vector<unsigned char>> read;
  for (const auto &[name, accessor] : primitive.attributes) {
    if (const auto id = primitive.draco->attributes.find(name); id != primitive.draco->attributes.end()) {
      read[name] = element_bytes(*mesh, name, id->second, file.model.accessors[accessor]);
    }
  }
  Plain plain{primitive.attributes, -1};
  for (auto &[name, bytes] : read) {
    plain.attributes[name] = add_accessor(file, std::move(bytes), file.model.accessors[primitive.attributes.at(name)]);
  }
  Model::Accessor indices;
  indices.component_type = Model::UnsignedInt;
  indices.count = 3 * std::uint64_t(mesh->num_faces());
  plain.indices = add_accessor(file, index_bytes(*mesh), std::move(indices));
  return plain;
}

}  // namespace

void decompress_draco(File &file, Progress &progress, Warnings &warnings)
{
  // Primitives that share compressed data remain one mesh of the scene.
  std::map<std::tuple<int, Attributes, Attributes>, Plain> done;
  for (std::size_t i = 0; i < file.model.meshes.size(); i++) {
    Model::Mesh &mesh = file.model.meshes[i];
    for (Model::Primitive &primitive : mesh.primitives) {
      progress.step();
      if (!primitive.draco) {
        continue;
      }
      const Model::Draco &draco = *primitive.draco;
      const auto [place, is_new] = done.try_emplace({draco.buffer_view, draco.attributes, primitive.attributes});
      try {
        if (is_new) {
          place->second = plain_of(file, primitive);
        }
        if (place->second.indices >= 0) {
          primitive.attributes = place->second.attributes;
          primitive.indices = place->second.indices;
          // The decoded form of a strip is a list.
          primitive.mode = Model::Triangles;
        }
      }
      catch (const Fault &fault) {
        // The accessors may refer to uncompressed data as a fallback.
        warnings.add_counted(label("mesh", mesh.name, i), 1,
                             std::string("its compressed form cannot be decoded: ") + fault.what());
      }
    }
  }
}

}  // namespace gnomon::gltf
