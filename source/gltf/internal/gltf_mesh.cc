// SPDX-License-Identifier: MIT
#include "internal/gltf_mesh.hh"

#include "internal/gltf_deform.hh"
#include "internal/gltf_facets.hh"
#include "internal/gltf_primitive.hh"
#include "internal/gltf_triangles.hh"
#include "scene_tangents.hh"

#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace gnomon::gltf {

using scene::Handle;
using scene::Mesh;
using scene::Scene;

namespace {

/** Name of the scene's mesh for a primitive. */
std::string primitive_name(const Model::Mesh &mesh, int mesh_index, std::size_t primitive_index)
{
  if (!mesh.primitives[primitive_index].name.empty()) {
    return mesh.primitives[primitive_index].name;
  }
  const std::string name = mesh.name.empty() ? "mesh " + std::to_string(mesh_index) : mesh.name;
  return mesh.primitives.size() > 1 ? name + '[' + std::to_string(primitive_index) + ']' : name;
}

}  // namespace

MeshImporter::MeshImporter(const File &file, const ImportOptions &options, Progress &progress, ForeignExtras &extras,
                           Warnings &warnings, Scene &scene)
    : file_(file),
      progress_(progress),
      extras_(extras),
      warnings_(warnings),
      scene_(scene),
      element_count_max_(options.element_count_max),
      materials_(file, options, extras, warnings, scene)
{
}

const scene::TextureSlot *MeshImporter::tangent_slot(Handle<scene::Material> handle) const
{
  const scene::Material &material = scene_.materials()[handle];
  return material.normal_texture                  ? &material.normal_texture
         : materials_.is_ever_anisotropic(handle) ? &material.anisotropy_texture
         : material.coat_normal_texture           ? &material.coat_normal_texture
                                                  : nullptr;
}

const std::vector<Handle<Mesh>> &MeshImporter::meshes_of(int gltf_mesh)
{
  const auto [place, is_new] = meshes_of_.try_emplace(gltf_mesh);
  if (is_new) {
    const std::size_t count = file_.model.meshes[gltf_mesh].primitives.size();
    for (std::size_t i = 0; i < count; i++) {
      import_primitive(gltf_mesh, i, place->second);
    }
  }
  return place->second;
}

void MeshImporter::spend(std::uint64_t element_count)
{
  // No overflow, because the count of an accessor is bounded by the size of a file.
  element_count_ += element_count;
  if (element_count_ > element_count_max_) {
    throw std::length_error("scene: has more than " + std::to_string(element_count_max_) +
                            " vertices and indices, the limit of --vertices-max");
  }
}

void MeshImporter::import_primitive(int gltf_mesh, std::size_t primitive_index, std::vector<Handle<Mesh>> &meshes)
{
  const Model::Mesh &source = file_.model.meshes[gltf_mesh];
  const Model::Primitive &primitive = source.primitives[primitive_index];
  const std::string name = primitive_name(source, gltf_mesh, primitive_index);
  primitive_count_++;
  const auto [place, is_new] = mesh_of_.try_emplace({name, primitive.attributes, primitive.indices, primitive.material,
                                                     primitive.mode, extras_.has("meshes", gltf_mesh) ? gltf_mesh : -1},
                                                    Handle<Mesh>());
  if (!is_new) {
    if (place->second) {
      meshes.push_back(place->second);
    }
    return;
  }
  place->second = read_primitive(gltf_mesh, primitive_index, std::nullopt);
  if (place->second) {
    meshes.push_back(place->second);
  }
}

std::vector<Handle<Mesh>> MeshImporter::deformed_meshes_of(int gltf_mesh, int skin)
{
  std::vector<Handle<Mesh>> meshes;
  const Model::Mesh &source = file_.model.meshes[gltf_mesh];
  for (std::size_t i = 0; i < source.primitives.size(); i++) {
    primitive_count_++;
    if (const Handle<Mesh> mesh = read_primitive(gltf_mesh, i, skin)) {
      meshes.push_back(mesh);
    }
  }
  return meshes;
}

bool MeshImporter::read_for_material(const Model::Primitive &primitive, PrimitiveReader &reader, Mesh &mesh)
{
  mesh.colors = reader.read_colors();
  const bool is_surface = mesh.topology == scene::Topology::Triangles;
  if (!is_surface) {
    mesh.tangents = reader.read_tangents();
  }
  mesh.material = is_surface
                      ? materials_.handle_of(primitive.material)
                      : materials_.handle_for_lines(primitive.material, reader.has_normals(), !mesh.tangents.empty());
  const std::vector<int> &uv_sets = materials_.uv_sets(mesh.material);
  // A surface function reads the sets that there are.
  const bool has_function = bool(scene_.materials()[mesh.material].surface_function);
  const auto read_uvs = [&](std::size_t i) {
    const bool is_read = i < uv_sets.size() &&
                         (!has_function || primitive.attributes.contains("TEXCOORD_" + std::to_string(uv_sets[i])));
    return is_read ? reader.read_uvs(uv_sets[i]) : std::vector<glm::vec2>();
  };
  mesh.uvs = read_uvs(0);
  mesh.second_uvs = read_uvs(1);
  if (const scene::TextureSlot *slot = tangent_slot(mesh.material)) {
    mesh.tangents = is_surface ? reader.read_tangents() : std::move(mesh.tangents);
    const bool has_uvs_for_tangents =
        mesh.tangents.empty() && mesh.uv_set(slot->uv_set).empty() && primitive.attributes.contains("TEXCOORD_0");
    if (has_uvs_for_tangents) {
      mesh.uvs = reader.read_uvs(0);
    }
    return has_uvs_for_tangents;
  }
  return false;
}

Handle<Mesh> MeshImporter::read_primitive(int gltf_mesh, std::size_t primitive_index, std::optional<int> deforming_skin)
{
  const Model::Mesh &source = file_.model.meshes[gltf_mesh];
  const Model::Primitive &primitive = source.primitives[primitive_index];
  const std::string what = label("mesh", source.name, static_cast<std::size_t>(gltf_mesh));
  progress_.step();
  Mesh mesh;
  std::optional<scene::DeformedMesh> deformed;
  /** The uvs are not those of a texture. */
  bool has_uvs_for_tangents = false;
  try {
    PrimitiveReader reader(file_, primitive, what, warnings_, deforming_skin.has_value());
    spend(reader.element_count());
    mesh = reader.read();
    if (!mesh.indices.empty()) {
      has_uvs_for_tangents = read_for_material(primitive, reader, mesh);
      if (deforming_skin) {
        make_missing_tangents(mesh, has_uvs_for_tangents, what);
        spend(reader.file_vertices().size() * deformed_width(primitive, *deforming_skin >= 0));
        deformed = read_deformed(file_, primitive, *deforming_skin, mesh, reader.file_vertices(), what, warnings_);
        deformed->has_flat_normals = mesh.topology == scene::Topology::Triangles && !reader.has_normals();
      }
    }
  }
  catch (const Fault &fault) {
    warnings_.add_counted(what, 1, std::string("primitive left out: ") + fault.what());
    return {};
  }
  if (mesh.indices.empty()) {
    // The lost triangles have been reported.
    return {};
  }
  mesh.name = primitive_name(source, gltf_mesh, primitive_index);
  mesh.extras = extras_.of("meshes", gltf_mesh);
  if (deformed) {
    // Its vertices stay those of the rest shape, so facets are left as the file has them.
    deformed->mesh = scene_.add(std::move(mesh));
    scene_.deformed_meshes.push_back(std::move(*deformed));
    return scene_.deformed_meshes.back().mesh;
  }
  if (mesh.topology == scene::Topology::Triangles) {
    flatten_facets(mesh);
  }
  make_missing_tangents(mesh, has_uvs_for_tangents, what);
  return scene_.add(std::move(mesh));
}

void MeshImporter::make_missing_tangents(Mesh &mesh, bool drops_uvs, const std::string &what)
{
  const scene::TextureSlot *slot = tangent_slot(mesh.material);
  if (slot == nullptr || !mesh.tangents.empty()) {
    return;
  }
  if (mesh.uv_set(slot->uv_set).empty()) {
    warnings_.add(what, "anisotropy is not drawn: there is neither TANGENT nor TEXCOORD_0");
    return;
  }
  scene::make_tangents(mesh, *slot);
  if (drops_uvs) {
    mesh.uvs.clear();
  }
}

}  // namespace gnomon::gltf
