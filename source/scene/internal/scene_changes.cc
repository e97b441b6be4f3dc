// SPDX-License-Identifier: MIT
#include "internal/scene_changes.hh"

#include <algorithm>

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

bool same_slot(const TextureSlot &a, const TextureSlot &b)
{
  return a.texture == b.texture && a.uv_set == b.uv_set && same_bytes(a.offset, b.offset) &&
         same_bytes(a.rotation, b.rotation) && same_bytes(a.scale, b.scale);
}

}  // namespace

Changes changes(const Mesh &a, const Mesh &b)
{
  using enum Mesh::Aspect;
  const bool same_shape = same_elements(a.positions, b.positions) && same_elements(a.normals, b.normals) &&
                          same_elements(a.uvs, b.uvs) && same_elements(a.second_uvs, b.second_uvs) &&
                          same_elements(a.tangents, b.tangents) && same_elements(a.colors, b.colors) &&
                          same_elements(a.indices, b.indices) && a.topology == b.topology &&
                          a.host_shape == b.host_shape;
  return bit_if(a.name != b.name, Name) | bit_if(!same_shape, Shape) | bit_if(a.material != b.material, Material);
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
  const bool same_surface =
      same_bytes(a.base_color, b.base_color) && same_bytes(a.metallic, b.metallic) &&
      same_bytes(a.roughness, b.roughness) && same_bytes(a.specular, b.specular) &&
      same_bytes(a.specular_color, b.specular_color) && same_bytes(a.emissive, b.emissive) &&
      same_bytes(a.normal_scale, b.normal_scale) && same_bytes(a.coat, b.coat) &&
      same_bytes(a.coat_roughness, b.coat_roughness) && same_bytes(a.coat_normal_scale, b.coat_normal_scale) &&
      same_bytes(a.sheen_color, b.sheen_color) && same_bytes(a.sheen_roughness, b.sheen_roughness) &&
      same_bytes(a.anisotropy, b.anisotropy) && same_bytes(a.anisotropy_rotation, b.anisotropy_rotation) &&
      same_bytes(a.occlusion_strength, b.occlusion_strength) && same_bytes(a.ior, b.ior);
  const bool same_volume = same_bytes(a.transmission, b.transmission) && same_bytes(a.thickness, b.thickness) &&
                           same_bytes(a.attenuation_distance, b.attenuation_distance) &&
                           same_bytes(a.attenuation_color, b.attenuation_color);
  // The shadow of what transmits light is as dark as the light's colour behind it.
  const bool same_shadow =
      (!a.has_transmission() && !b.has_transmission()) ||
      (same_volume && same_bytes(a.base_color, b.base_color) && same_bytes(a.metallic, b.metallic));
  // A surface function may compute alpha from all factors.
  const bool same_function =
      a.surface_function == b.surface_function &&
      (!a.surface_function || a.alpha_mode == AlphaMode::Opaque || (same_surface && same_volume));
  const bool same_coverage = same_bytes(a.alpha, b.alpha) && a.alpha_mode == b.alpha_mode && same_shadow &&
                             same_bytes(a.alpha_cutoff, b.alpha_cutoff) && a.is_double_sided == b.is_double_sided &&
                             same_function;
  // An unlit material, and one without layers, reads fewer textures; one with a surface function reads more.
  const bool same_textures = a.surface_function == b.surface_function && a.is_unlit == b.is_unlit &&
                             a.has_coat() == b.has_coat() && a.has_sheen() == b.has_sheen() &&
                             a.has_anisotropy() == b.has_anisotropy() && a.has_transmission() == b.has_transmission() &&
                             std::ranges::all_of(texture_inputs, [&](const TextureInput &input) {
                               return same_slot(a.*input.slot, b.*input.slot);
                             });
  return bit_if(a.name != b.name, Name) | bit_if(!same_surface || !same_volume, Surface) |
         bit_if(!same_coverage, Coverage) | bit_if(!same_textures, Textures);
}

Changes changes(const Lamp &a, const Lamp &b)
{
  using enum Lamp::Aspect;
  const bool same_light = same_bytes(a.color, b.color) && same_bytes(a.intensity, b.intensity);
  const bool same_shape = a.kind == b.kind && same_bytes(a.radius, b.radius) && same_bytes(a.angle, b.angle) &&
                          same_bytes(a.spot_outer_angle, b.spot_outer_angle) &&
                          same_bytes(a.spot_blend, b.spot_blend) && same_bytes(a.range, b.range) &&
                          a.area_shape == b.area_shape && same_bytes(a.area_size_x, b.area_size_x) &&
                          same_bytes(a.area_size_y, b.area_size_y);
  return bit_if(a.name != b.name, Name) | bit_if(!same_light, Light) | bit_if(!same_shape, Shape) |
         bit_if(a.shadow != b.shadow, Shadow);
}

Changes changes(const Camera &a, const Camera &b)
{
  const bool same_lens = a.kind == b.kind && same_bytes(a.vertical_angle, b.vertical_angle) &&
                         same_bytes(a.aspect, b.aspect) && same_bytes(a.half_width, b.half_width) &&
                         same_bytes(a.half_height, b.half_height) && same_bytes(a.near, b.near) &&
                         same_bytes(a.far, b.far);
  return bit_if(a.name != b.name, Camera::Aspect::Name) | bit_if(!same_lens, Camera::Aspect::Lens);
}

Changes changes(const Node &a, const Node &b)
{
  using enum Node::Aspect;
  const bool same_content = a.meshes == b.meshes && a.lamp == b.lamp && a.camera == b.camera;
  const bool same_shadow = a.casts_shadow == b.casts_shadow && a.receives_shadow == b.receives_shadow;
  return bit_if(a.name != b.name, Name) | bit_if(!same_content, Content) | bit_if(!same_shadow, Shadow);
}

}  // namespace gnomon::scene
