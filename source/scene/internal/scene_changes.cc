// SPDX-License-Identifier: MIT
#include "internal/scene_changes.hh"

#include <algorithm>
#include <type_traits>

namespace gnomon::scene {

namespace {

template <typename Aspect>
Changes bit_if(bool differs, Aspect aspect)
{
  return differs ? 1U << unsigned(aspect) : 0U;
}

template <typename T>
bool same_elements(const std::vector<T> &a, const std::vector<T> &b)
{
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

template <typename Value>
bool same_value(const Value &a, const Value &b)
{
  if constexpr (std::is_floating_point_v<Value> || requires {
                  a.length();
                  a.x;
                }) {
    return same_bytes(a, b);
  }
  else {
    return a == b;
  }
}

/** The aspects of the properties that differ. */
template <typename Thing>
Changes property_changes(const Thing &a, const Thing &b)
{
  Changes changed = 0;
  Thing::for_each_property(
      [&](const auto &row) { changed |= same_value(a.*row.member, b.*row.member) ? 0U : 1U << row.aspect; });
  return changed;
}

bool same_slot(const TextureSlot &a, const TextureSlot &b)
{
  return a.texture == b.texture && property_changes(a, b) == 0;
}

}  // namespace

Changes changes(const Mesh &a, const Mesh &b)
{
  using enum Mesh::Aspect;
  bool same_layout = same_elements(a.indices, b.indices) && a.topology == b.topology && a.host_shape == b.host_shape;
  bool same_values = true;
  for_each_stream_member([&](auto stream, auto /*values*/, std::string_view /*name*/) {
    same_layout = same_layout && (a.*stream).size() == (b.*stream).size();
    same_values = same_values && same_elements(a.*stream, b.*stream);
  });
  return bit_if(a.name != b.name || a.extras != b.extras, Name) | bit_if(!same_layout || !same_values, Shape) |
         bit_if(!same_layout, Layout) | bit_if(a.material != b.material, Material);
}

Changes changes(const Image &a, const Image &b)
{
  using enum Image::Aspect;
  const bool same_content = a.width == b.width && a.height == b.height && same_elements(a.texels, b.texels);
  return bit_if(a.name != b.name, Name) | bit_if(!same_content, Content);
}

Changes changes(const Texture &a, const Texture &b)
{
  const bool same_sampler = a.wrap_u == b.wrap_u && a.wrap_v == b.wrap_v && a.magnified == b.magnified &&
                            a.minified == b.minified && a.mip == b.mip;
  return bit_if(a.image != b.image, Texture::Aspect::Image) | bit_if(!same_sampler, Texture::Aspect::Sampler);
}

Changes changes(const SurfaceFunction &a, const SurfaceFunction &b)
{
  using enum SurfaceFunction::Aspect;
  return bit_if(a.name != b.name, Name) | bit_if(a.text != b.text || a.path != b.path, Text);
}

Changes changes(const Material &a, const Material &b)
{
  using enum Material::Aspect;
  const Changes changed = property_changes(a, b);
  // The shadow of a transmissive surface depends on the colour of the transmitted light.
  const bool same_shadow = (!a.has_transmission() && !b.has_transmission()) ||
                           (same_bytes(a.transmission, b.transmission) && same_bytes(a.thickness, b.thickness) &&
                            same_bytes(a.attenuation_distance, b.attenuation_distance) &&
                            same_bytes(a.attenuation_color, b.attenuation_color) &&
                            same_bytes(a.base_color, b.base_color) && same_bytes(a.metallic, b.metallic));
  // A surface function may compute alpha from all factors.
  const bool same_function =
      a.surface_function == b.surface_function &&
      (!a.surface_function || a.alpha_mode == AlphaMode::Opaque || (changed & 1U << unsigned(Surface)) == 0);
  // An unlit material, and one without layers, reads fewer textures; one with a surface function reads more.
  const bool same_textures =
      a.surface_function == b.surface_function && a.has_coat() == b.has_coat() && a.has_sheen() == b.has_sheen() &&
      a.has_anisotropy() == b.has_anisotropy() && a.has_transmission() == b.has_transmission() &&
      std::ranges::all_of(texture_inputs,
                          [&](const TextureInput &input) { return same_slot(a.*input.slot, b.*input.slot); });
  return changed | bit_if(!same_shadow || !same_function, Coverage) | bit_if(!same_textures, Textures);
}

Changes changes(const Lamp &a, const Lamp &b)
{
  return property_changes(a, b) | property_changes(a.shadow, b.shadow);
}

Changes changes(const Camera &a, const Camera &b)
{
  return property_changes(a, b);
}

Changes changes(const Node &a, const Node &b)
{
  const bool same_content = a.meshes == b.meshes && a.lamp == b.lamp && a.camera == b.camera;
  constexpr Changes of_ancestors = 1U << unsigned(Node::Aspect::Visibility);
  return (property_changes(a, b) & ~of_ancestors) | bit_if(!same_content, Node::Aspect::Content);
}

}  // namespace gnomon::scene
