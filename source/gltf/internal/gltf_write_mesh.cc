// SPDX-License-Identifier: MIT
#include "internal/gltf_write_mesh.hh"

#include "image_base64.hh"
#include "internal/gltf_foreign_extras.hh"
#include "internal/gltf_model.hh"
#include "internal/gltf_pointer.hh"
#include "internal/gltf_report.hh"
#include "internal/gltf_sampler.hh"
#include "internal/gltf_units.hh"
#include "internal/gltf_write_uri.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <type_traits>

namespace gnomon::gltf {

using scene::AlphaMode;
using scene::Handle;
using scene::Image;
using scene::Material;
using scene::Mesh;
using scene::MipFilter;
using scene::Texture;
using scene::TextureFilter;
using scene::TextureWrap;

namespace {

/** The start of the paths of a material's extensions. */
constexpr std::string_view extensions_path = "extensions/";

/** The name that the importer gives to a primitive without a name. */
std::string derived_name(const std::string &mesh_name, std::size_t primitive, std::size_t primitive_count)
{
  return primitive_count == 1 ? mesh_name : mesh_name + '[' + std::to_string(primitive) + ']';
}

int gl_wrap(TextureWrap wrap)
{
  return wrap == TextureWrap::Repeat        ? gl_repeat
         : wrap == TextureWrap::ClampToEdge ? gl_clamp_to_edge
                                            : gl_mirrored_repeat;
}

int gl_minified(TextureFilter filter, MipFilter mip)
{
  const bool is_linear = filter == TextureFilter::Linear;
  switch (mip) {
    case MipFilter::None: return is_linear ? gl_linear : gl_nearest;
    case MipFilter::Nearest: return is_linear ? gl_linear_mipmap_nearest : gl_nearest_mipmap_nearest;
    case MipFilter::Linear: break;
  }
  return is_linear ? gl_linear_mipmap_linear : gl_nearest_mipmap_linear;
}

/** Two factors that glTF separates, and the importer multiplies. */
struct IorAndColor {
  /** Absent: glTF's default of 1.5. */
  std::optional<float> ior;
  glm::vec3 specular_color;
};

/** An index that reflects nothing cannot be written with a specular colour that reflects; the colour is kept. */
IorAndColor without_ior(const Material &material)
{
  const float ratio = reflectance_ratio(material.ior);
  const bool is_black = material.specular_color == glm::vec3(0.0F);
  if (material.ior == Material().ior || !(material.ior >= 1.0F) || (ratio == 0.0F && !is_black)) {
    return {std::nullopt, material.specular_color};
  }
  return {material.ior, ratio == 0.0F ? glm::vec3(1.0F) : material.specular_color / ratio};
}

}  // namespace

float emissive_strength(const glm::vec3 &emissive)
{
  const float largest = std::max({emissive.x, emissive.y, emissive.z});
  if (!(largest > 1.0F) || !std::isfinite(largest)) {
    return 1.0F;
  }
  int exponent = 0;
  const float mantissa = std::frexp(largest, &exponent);
  return std::ldexp(1.0F, mantissa == 0.5F ? exponent - 1 : exponent);
}

MeshWriter::MeshWriter(const scene::Scene &scene, WrittenBuffer &buffer, std::filesystem::path folder)
    : scene_(scene), buffer_(buffer), folder_(std::move(folder))
{
  for (const scene::DeformedMesh &deformed : scene.deformed_meshes) {
    if (scene.nodes().is_live(deformed.node) && scene::fault_of(scene, deformed).empty()) {
      deformed_of_.emplace(deformed.mesh, &deformed);
    }
  }
}

const scene::DeformedMesh *MeshWriter::deformed_of(const std::vector<Handle<Mesh>> &node_meshes) const
{
  for (const Handle<Mesh> mesh : node_meshes) {
    if (const auto found = deformed_of_.find(mesh); found != deformed_of_.end()) {
      return found->second;
    }
  }
  return nullptr;
}

int MeshWriter::index_of(const std::vector<Handle<Mesh>> &node_meshes, bool is_deformed)
{
  std::vector<Handle<Mesh>> drawn;
  std::copy_if(node_meshes.begin(), node_meshes.end(), std::back_inserter(drawn), [this](Handle<Mesh> handle) {
    const Mesh *mesh = scene_.meshes().find(handle);
    return mesh != nullptr && !mesh->indices.empty();
  });
  if (drawn.empty()) {
    return -1;
  }
  const auto [place, is_new] = mesh_of_.try_emplace({drawn, is_deformed}, 0);
  if (!is_new) {
    return place->second;
  }
  std::string name = scene_.meshes()[drawn.front()].name;
  constexpr std::string_view first = "[0]";
  if (drawn.size() > 1 && std::string_view(name).ends_with(first)) {
    name.resize(name.size() - first.size());
  }
  JsonText primitives;
  std::vector<std::string_view> extras;
  for (std::size_t i = 0; i < drawn.size(); i++) {
    const Mesh &mesh = scene_.meshes()[drawn[i]];
    JsonText json = primitive(drawn[i], is_deformed);
    if (mesh.name != derived_name(name, i, drawn.size())) {
      json.add("extras", "{\"gnomon_name\":" + json_string(mesh.name, what_of("mesh", mesh.name)) + '}');
    }
    primitives.add(json.object());
    if (std::ranges::find(extras, mesh.extras) == extras.end()) {
      extras.push_back(mesh.extras);
    }
  }
  JsonText json;
  json.add("name", json_string(name, what_of("mesh", name)));
  json.add("primitives", primitives.array());
  add_extras({}, extras, what_of("mesh", name), json);
  place->second = meshes.add(json.object());
  return place->second;
}

const JsonText &MeshWriter::primitive(Handle<Mesh> handle, bool is_deformed)
{
  const auto [place, is_new] = primitive_of_.try_emplace({handle, is_deformed});
  if (!is_new) {
    return place->second;
  }
  const Mesh &mesh = scene_.meshes()[handle];
  const std::string what = what_of("mesh", mesh.name);
  const auto found = deformed_of_.find(handle);
  const scene::DeformedMesh *const deformed = is_deformed && found != deformed_of_.end() ? found->second : nullptr;
  JsonText attributes;
  const auto add = [&](std::string_view key, const auto &values, std::string_view type, const std::string &more) {
    attributes.add(key, std::to_string(buffer_.add_accessor(values, Model::Float, type, more)));
  };
  add_positions("POSITION", deformed ? deformed->positions : mesh.positions, what, attributes);
  // The importer makes flat normals.
  if (!deformed || !deformed->has_flat_normals) {
    add("NORMAL", deformed ? deformed->normals : mesh.normals, "VEC3", "");
  }
  if (!mesh.uvs.empty()) {
    add("TEXCOORD_0", mesh.uvs, "VEC2", "");
  }
  if (!mesh.second_uvs.empty()) {
    add("TEXCOORD_1", mesh.second_uvs, "VEC2", "");
  }
  if (!mesh.tangents.empty()) {
    add("TANGENT", deformed ? deformed->tangents : mesh.tangents, "VEC4", "");
  }
  if (!mesh.colors.empty()) {
    add("COLOR_0", mesh.colors, "VEC4", "");
  }
  if (deformed) {
    add_deformation(*deformed, what, attributes, place->second);
  }
  place->second.add("attributes", attributes.object());
  if (mesh.topology != scene::Topology::Triangles) {
    place->second.add("mode", std::to_string(mesh.topology == scene::Topology::Lines ? Model::Lines : Model::Points));
  }
  place->second.add("indices",
                    std::to_string(buffer_.add_accessor(deformed ? rest_indices(mesh, *deformed) : mesh.indices,
                                                        Model::UnsignedInt, "SCALAR")));
  if (scene_.materials().is_live(mesh.material)) {
    place->second.add("material", std::to_string(material(mesh.material)));
  }
  return place->second;
}

void MeshWriter::add_deformation(const scene::DeformedMesh &deformed, const std::string &what, JsonText &attributes,
                                 JsonText &primitive)
{
  if (deformed.skin >= 0) {
    for (std::size_t set = 0; set < deformed.joint_sets; set++) {
      std::vector<std::array<std::uint16_t, 4>> joints;
      std::vector<glm::vec4> weights;
      for (std::size_t i = set; i < deformed.joint_weights.size(); i += deformed.joint_sets) {
        joints.push_back(deformed.joint_weights[i].joints);
        weights.push_back(deformed.joint_weights[i].weights);
      }
      const std::string number = std::to_string(set);
      attributes.add("JOINTS_" + number, std::to_string(buffer_.add_accessor(joints, Model::UnsignedShort, "VEC4")));
      attributes.add("WEIGHTS_" + number, std::to_string(buffer_.add_accessor(weights, Model::Float, "VEC4")));
    }
  }
  JsonText targets;
  for (const scene::MorphTarget &target : deformed.targets) {
    JsonText json;
    // A target has at least one attribute. Without differences, they are 0.
    add_positions("POSITION",
                  target.positions.empty() ? std::vector<glm::vec3>(deformed.positions.size()) : target.positions, what,
                  json);
    if (!target.normals.empty() && !deformed.has_flat_normals) {
      json.add("NORMAL", std::to_string(buffer_.add_accessor(target.normals, Model::Float, "VEC3")));
    }
    if (!target.tangents.empty()) {
      json.add("TANGENT", std::to_string(buffer_.add_accessor(target.tangents, Model::Float, "VEC3")));
    }
    targets.add(json.object());
  }
  if (!targets.empty()) {
    primitive.add("targets", targets.array());
  }
}

void MeshWriter::add_positions(std::string_view key, const std::vector<glm::vec3> &positions, const std::string &what,
                               JsonText &attributes)
{
  scene::Bounds bounds;
  for (const glm::vec3 &position : positions) {
    bounds.extend(position);
  }
  const std::string limits =
      ",\"min\":" + json_numbers(bounds.min, what) + ",\"max\":" + json_numbers(bounds.max, what);
  attributes.add(key, std::to_string(buffer_.add_accessor(positions, Model::Float, "VEC3", limits)));
}

/** An object of a material, such as an extension or a texture slot. */
struct MaterialPart {
  JsonText json;
  /** Whether one of its values differs from the default of glTF. */
  bool is_needed = false;
};

/** The objects of a material by their paths from it; the material's own is empty. */
using MaterialParts = std::map<std::string_view, MaterialPart>;

static void add_member(MaterialParts &parts, std::string_view path, const std::string &value, bool is_needed)
{
  const std::size_t last = path.rfind('/');
  MaterialPart &part = parts[path.substr(0, last == path.npos ? 0 : last)];
  part.json.add(path.substr(last + 1), value);
  part.is_needed |= is_needed;
}

/** Adds the properties that have a place in glTF. \a material: with the values of the file */
static void add_factors(const Material &material, const std::string &what, MaterialParts &parts)
{
  static const Material plain;
  Material::for_each_property([&](const auto &row) {
    using Value = typename std::decay_t<decltype(row)>::Value;
    const auto &value = material.*row.member;
    const bool is_needed = value != plain.*row.member;
    if (row.path.empty()) {
      return;
    }
    if constexpr (std::is_same_v<Value, bool>) {
      if (row.path.starts_with(extensions_path)) {
        // The extension has no members.
        parts[row.path].is_needed = value;
      }
      else {
        add_member(parts, row.path, value ? "true" : "false", is_needed);
      }
    }
    else if constexpr (std::is_same_v<Value, float>) {
      // The scene has 0 for a value that glTF has no number for: the member is left out.
      if (value != 0.0F || row.zero.empty()) {
        add_member(parts, row.path, json_number(value, what), is_needed);
      }
    }
    else if constexpr (std::is_same_v<Value, glm::vec3>) {
      const bool has_alpha = row.name == "base_color";
      add_member(parts, row.path,
                 has_alpha ? json_numbers(glm::vec4(value, material.alpha), what) : json_numbers(value, what),
                 is_needed);
    }
  });
  add_member(parts, "alphaMode",
             material.alpha_mode == AlphaMode::Mask    ? "\"MASK\""
             : material.alpha_mode == AlphaMode::Blend ? "\"BLEND\""
                                                       : "\"OPAQUE\"",
             true);
}

int MeshWriter::material(Handle<Material> handle)
{
  if (const auto found = material_of_.find(handle); found != material_of_.end()) {
    return found->second;
  }
  const Material &material = scene_.materials()[handle];
  const std::string what = what_of("material", material.name);
  const float strength = emissive_strength(material.emissive);
  const IorAndColor split = without_ior(material);
  Material written = material;
  written.emissive /= strength;
  written.ior = split.ior.value_or(Material().ior);
  written.specular_color = split.specular_color;
  MaterialParts parts;
  // Values that have no effect now are kept, too: another value may give them one.
  add_factors(written, what, parts);
  if (strength != 1.0F) {
    add_member(parts, strength_path, json_number(strength, what), true);
  }
  for (const scene::TextureInput &input : scene::texture_inputs) {
    // add_factors has added the slot's factor, if it has one.
    JsonText &slot = parts[input.path].json;
    if (add_slot(slot, material.*input.slot, what)) {
      add_member(parts, input.path, slot.object(), true);
    }
  }
  JsonText used;
  for (const auto &[path, part] : parts) {
    const std::string_view name = path.substr(std::min(path.size(), extensions_path.size()));
    if (part.is_needed && path.starts_with(extensions_path) && name.find('/') == name.npos) {
      extensions.insert(std::string(name));
      used.add(name, part.json.object());
    }
  }
  JsonText &json = parts[""].json;
  json.add("name", json_string(material.name, what));
  json.add("pbrMetallicRoughness", parts["pbrMetallicRoughness"].json.object());
  if (!used.empty()) {
    json.add("extensions", used.object());
  }
  JsonText extras;
  if (const scene::SurfaceFunction *function = scene_.surface_functions().find(material.surface_function)) {
    extras.add("gnomon_surface", '"' + surface_uri(*function) + '"');
  }
  add_extras(std::move(extras), {material.extras}, what, json);
  return material_of_.emplace(handle, materials.add(json.object())).first->second;
}

std::string MeshWriter::surface_uri(const scene::SurfaceFunction &function) const
{
  const std::string uri = uri_of_file(function.path, folder_);
  const std::span text(reinterpret_cast<const unsigned char *>(function.text.data()), function.text.size());
  return uri.empty() ? "data:text/plain;base64," + image::base64(text) : uri;
}

bool MeshWriter::add_slot(JsonText &json, const scene::TextureSlot &slot, const std::string &what)
{
  const Texture *found = scene_.textures().find(slot.texture);
  if (found == nullptr || !scene_.images().is_live(found->image)) {
    return false;
  }
  json.add("index", std::to_string(texture(slot.texture)));
  if (slot.uv_set != 0) {
    json.add("texCoord", std::to_string(slot.uv_set));
  }
  if (slot.is_transformed()) {
    extensions.insert("KHR_texture_transform");
    json.add("extensions", "{\"KHR_texture_transform\":{\"offset\":" + json_numbers(slot.offset, what) +
                               ",\"rotation\":" + json_number(slot.rotation, what) +
                               ",\"scale\":" + json_numbers(slot.scale, what) + "}}");
  }
  return true;
}

int MeshWriter::texture(Handle<Texture> handle)
{
  if (const auto found = texture_of_.find(handle); found != texture_of_.end()) {
    return found->second;
  }
  const Texture &texture = scene_.textures()[handle];
  JsonText json;
  json.add("sampler", std::to_string(sampler(texture)));
  json.add("source", std::to_string(image(texture.image)));
  return texture_of_.emplace(handle, textures.add(json.object())).first->second;
}

int MeshWriter::sampler(const Texture &texture)
{
  JsonText json;
  json.add("magFilter", std::to_string(texture.magnified == TextureFilter::Linear ? gl_linear : gl_nearest));
  json.add("minFilter", std::to_string(gl_minified(texture.minified, texture.mip)));
  json.add("wrapS", std::to_string(gl_wrap(texture.wrap_u)));
  json.add("wrapT", std::to_string(gl_wrap(texture.wrap_v)));
  const auto [place, is_new] = sampler_of_.try_emplace(json.object(), 0);
  if (is_new) {
    place->second = samplers.add(json.object());
  }
  return place->second;
}

int MeshWriter::image(Handle<Image> handle)
{
  if (const auto found = image_of_.find(handle); found != image_of_.end()) {
    return found->second;
  }
  const Image &image = scene_.images()[handle];
  const std::string what = what_of("image", image.name);
  JsonText json;
  json.add("name", json_string(image.name, what));
  json.add("mimeType", "\"image/png\"");
  json.add("bufferView", std::to_string(buffer_.add_view(png_of(image, what))));
  return image_of_.emplace(handle, images.add(json.object())).first->second;
}

}  // namespace gnomon::gltf
