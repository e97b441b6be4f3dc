// SPDX-License-Identifier: MIT
#include "render_materials.hh"

#include "render_images.hh"

#include "eevee_bsdf_shared.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <utility>

namespace gnomon::render_scene {

bool is_drawable(const scene::Material &material)
{
  switch (material.alpha_mode) {
    case scene::AlphaMode::Mask: return material.alpha >= material.alpha_cutoff;
    case scene::AlphaMode::Blend: return material.alpha > 0.0F;
    default: return true;
  }
}

bool is_drawable(const scene::Scene &scene, const scene::Material &material)
{
  return has_surface_function(scene, material) || is_drawable(material);
}

bool has_surface_function(const scene::Scene &scene, const scene::Material &material)
{
  return scene.surface_functions().is_live(material.surface_function);
}

bool is_blended(const scene::Scene &scene, const scene::Mesh &mesh)
{
  const scene::Material &material = scene.material_of(mesh);
  if (material.alpha_mode != scene::AlphaMode::Blend) {
    return false;
  }
  const scene::Handle<scene::Texture> texture = material.base_color_texture.texture;
  return material.alpha < 1.0F || mesh.has_colors() || has_surface_function(scene, material) ||
         (is_drawable(scene, texture) && !scene.images()[scene.textures()[texture].image].is_opaque);
}

bool lets_light_through(const scene::Scene &scene, const scene::Mesh &mesh)
{
  const scene::Material &material = scene.material_of(mesh);
  return is_blended(scene, mesh) || (material.has_transmission() && material.alpha_mode == scene::AlphaMode::Opaque &&
                                     !is_drawable(scene, mesh, material.transmission_texture));
}

bool has_open_shadow(const scene::Scene &scene, const scene::Mesh &mesh)
{
  return is_blended(scene, mesh) || (lets_light_through(scene, mesh) && !(scene.material_of(mesh).thickness > 0.0F));
}

bool has_closed_shadow(const scene::Scene &scene, const scene::Mesh &mesh)
{
  return mesh.topology == scene::Topology::Triangles && !has_open_shadow(scene, mesh);
}

/** Absorption coefficient of the material's volume, 1/m. */
static glm::vec3 absorption(const scene::Material &material)
{
  return material.attenuation_distance > 0.0F
             ? shared::absorption_of(material.attenuation_color, material.attenuation_distance)
             : glm::vec3(0.0F);
}

/** In the range that floats of the device hold. */
static float thickness(const scene::Material &material)
{
  // NaN becomes the first argument.
  return std::clamp(std::max(0.0F, material.thickness), 0.0F, float(scene::number_max));
}

float transmitted_part(const scene::Material &material)
{
  return std::clamp(std::max(0.0F, material.transmission), 0.0F, 1.0F) * (1.0F - material.metallic) *
         shared::luminance(shared::beer_lambert(absorption(material), thickness(material)));
}

bool is_drawable(const scene::Scene &scene, const scene::Mesh &mesh, const scene::TextureSlot &slot)
{
  return is_drawable(scene, slot.texture) && mesh.has_uvs(slot.uv_set);
}

MaterialClass material_class(const scene::Scene &scene, const scene::Mesh &mesh)
{
  const scene::Material &material = scene.material_of(mesh);
  if (material.has_transmission()) {
    return MaterialClass::Transmissive;
  }
  if (material.has_coat() || material.has_sheen() || (material.has_anisotropy() && mesh.has_tangents())) {
    return MaterialClass::Layered;
  }
  const scene::TextureSlot &base_color = material.base_color_texture;
  const auto full_inputs = std::span(scene::texture_inputs).first<FULL_TEXTURE_COUNT>();
  const bool is_full = std::ranges::any_of(full_inputs, [&](const scene::TextureInput &input) {
    const scene::TextureSlot &slot = material.*input.slot;
    if (!is_drawable(scene, mesh, slot)) {
      return false;
    }
    if (input.slot == &scene::Material::base_color_texture) {
      return slot.uv_set != 0 || slot.is_transformed() || material.is_unlit;
    }
    return input.slot != &scene::Material::normal_texture || mesh.has_tangents();
  });
  if (is_full || mesh.has_colors() || is_blended(scene, mesh) || has_surface_function(scene, material)) {
    return MaterialClass::Full;
  }
  return is_drawable(scene, mesh, base_color) ? MaterialClass::BaseColor : MaterialClass::Plain;
}

bool is_masked(const scene::Scene &scene, const scene::Mesh &mesh)
{
  const scene::Material &material = scene.material_of(mesh);
  if (material.alpha_mode != scene::AlphaMode::Mask || !(material.alpha_cutoff > 0.0F)) {
    return false;
  }
  return has_surface_function(scene, material) ||
         (is_drawable(material) && (is_drawable(scene, mesh, material.base_color_texture) || mesh.has_colors()));
}

shared::MaterialData material_data(const scene::Material &material)
{
  shared::MaterialData data = material.is_unlit ? shared::unlit_material(material.base_color)
                                                : shared::metallic_roughness_material(
                                                      material.base_color, material.metallic, material.roughness,
                                                      material.specular_color, material.specular);
  if (!material.is_unlit && !material.emissive_texture) {
    data.emissive = material.emissive;
  }
  if (material.alpha_mode == scene::AlphaMode::Mask && is_drawable(material) && material.alpha_cutoff > 0.0F) {
    data.mask_cutoff = material.alpha_cutoff / material.alpha;
  }
  return data;
}

/** Writes two rows for each texture input from number \a first on, as many as \a rows has. */
static void write_uv_rows(const scene::Material &material, std::size_t first, std::span<glm::vec4> rows)
{
  for (std::size_t i = 0; i < rows.size(); i++) {
    const scene::TextureSlot &slot = material.*scene::texture_inputs[first + i / 2].slot;
    const glm::dmat3x2 uv_from_mesh = slot.uv_from_mesh();
    const int row = int(i % 2);
    rows[i] = {uv_from_mesh[0][row], uv_from_mesh[1][row], uv_from_mesh[2][row], slot.uv_set};
  }
}

shared::FullMaterialData full_material_data(const scene::Scene &scene, const scene::Material &material)
{
  shared::FullMaterialData data{};
  data.base_color = material.base_color;
  data.metallic = material.metallic;
  data.roughness = material.roughness;
  data.specular_color = material.specular_color;
  data.specular = material.specular;
  data.emissive = is_drawable(scene, material.emissive_texture.texture) || !material.emissive_texture
                      ? material.emissive
                      : glm::vec3(0.0F);
  data.normal_scale = material.normal_scale;
  data.occlusion_strength = material.occlusion_strength;
  data.inputs = material.is_unlit ? INPUT_UNLIT : 0U;
  if (material.alpha_mode == scene::AlphaMode::Blend) {
    data.inputs |= INPUT_BLENDED;
    data.opacity = material.alpha;
  }
  else {
    const bool is_open = material.has_transmission() && material.alpha_mode == scene::AlphaMode::Opaque;
    data.opacity = 1.0F - (is_open ? transmitted_part(material) : 0.0F);
  }
  if (material.alpha_mode == scene::AlphaMode::Mask && has_surface_function(scene, material)) {
    data.inputs |= INPUT_MASKED;
    data.opacity = material.alpha;
  }
  for (std::size_t i = 0; i < scene::texture_inputs.size(); i++) {
    const scene::TextureSlot &slot = material.*scene::texture_inputs[i].slot;
    if (is_drawable(scene, slot.texture)) {
      data.inputs |= 1U << i;
    }
  }
  write_uv_rows(material, 0, data.uv_rows);
  return data;
}

shared::LayerData layer_data(const scene::Material &material)
{
  shared::LayerData data{};
  data.coat = material.coat;
  data.coat_roughness = material.coat_roughness;
  data.sheen_color = material.sheen_color;
  data.sheen_roughness = material.sheen_roughness;
  data.anisotropy = {std::cos(material.anisotropy_rotation), std::sin(material.anisotropy_rotation),
                     std::clamp(std::max(0.0F, material.anisotropy), 0.0F, 1.0F)};
  data.coat_normal_scale = material.coat_normal_scale;
  data.transmission = std::clamp(std::max(0.0F, material.transmission), 0.0F, 1.0F);
  data.thickness = thickness(material);
  data.ior = std::clamp(std::max(1.0F, material.ior), 1.0F, float(scene::number_max));
  data.absorption = absorption(material);
  write_uv_rows(material, FULL_TEXTURE_COUNT, data.uv_rows);
  return data;
}

std::uint32_t MaterialTable::place_of(const scene::Scene &scene, scene::Handle<scene::Material> material)
{
  return scene.materials().is_live(material) ? material.index + 1 : 0;
}

template <typename Entry>
void MaterialTable::replace(std::vector<Entry> &entries, std::vector<Entry> changed, Block &block)
{
  for (std::size_t place = 0; place < changed.size(); place++) {
    const bool is_same = place < entries.size() && std::memcmp(&changed[place], &entries[place], sizeof(Entry)) == 0;
    if (!is_same) {
      block.changed_begin = std::min(block.changed_begin, place);
      block.changed_end = std::max(block.changed_end, place + 1);
    }
  }
  entries = std::move(changed);
}

static scene::Material without_emission(scene::Material material)
{
  material.emissive = glm::vec3(0.0F);
  if (material.is_unlit) {
    material.base_color = glm::vec3(0.0F);
  }
  return material;
}

void MaterialTable::update(const scene::Scene &scene)
{
  const scene::Pool<scene::Material> &materials = scene.materials();
  // Textures, images and functions count too, because removing one changes which can be drawn.
  const scene::Revision latest =
      std::max({materials.latest(), scene.textures().latest(), scene.images().latest(scene::Image::Aspect::Content),
                scene.surface_functions().latest()});
  if (!entries_.empty() && latest == seen_) {
    return;
  }
  std::vector<shared::MaterialData> entries(materials.index_end() + 1, material_data({}));
  std::vector<shared::FullMaterialData> full_entries(entries.size(), full_material_data(scene, {}));
  std::vector<shared::LayerData> layer_entries(entries.size(), layer_data({}));
  for (const auto &[handle, material] : materials) {
    const std::optional<scene::Material> dark =
        emission_ == Emission::LeftOut ? std::optional(without_emission(material)) : std::nullopt;
    const scene::Material &shown = dark ? *dark : material;
    entries[handle.index + 1] = material_data(shown);
    if (shown.alpha_mode == scene::AlphaMode::Mask && has_surface_function(scene, shown)) {
      // The function's alpha contains the factor.
      entries[handle.index + 1].mask_cutoff = shown.alpha_cutoff;
    }
    full_entries[handle.index + 1] = full_material_data(scene, shown);
    layer_entries[handle.index + 1] = layer_data(shown);
  }
  replace(entries_, std::move(entries), entries_block_);
  replace(full_entries_, std::move(full_entries), full_block_);
  replace(layer_entries_, std::move(layer_entries), layer_block_);
  seen_ = latest;
}

template <typename Entry>
void MaterialTable::upload(gpu::Device &device, const char *name, const std::vector<Entry> &entries, Block &block)
{
  const auto bytes = std::as_bytes(std::span(entries));
  bool is_all_changed = std::exchange(block.loss_count, device.loss_count()) != device.loss_count();
  if (!block.buffer || block.buffer.size_bytes() != bytes.size()) {
    block.buffer = device.create_buffer({name, gpu::BufferKind::Storage, bytes.size()});
    is_all_changed = true;
  }
  if (is_all_changed) {
    block.changed_begin = 0;
    block.changed_end = entries.size();
  }
  if (block.changed_begin < block.changed_end) {
    const std::size_t first = block.changed_begin * sizeof(Entry);
    device.update(block.buffer, first, bytes.subspan(first, block.changed_end * sizeof(Entry) - first));
    block.changed_begin = entries.size();
    block.changed_end = 0;
  }
}

void MaterialTable::upload(gpu::Device &device, MaterialClass widest)
{
  upload(device, "material_block", entries_, entries_block_);
  if (widest >= MaterialClass::Full || full_block_.buffer) {
    upload(device, "full_material_block", full_entries_, full_block_);
  }
  if (widest >= MaterialClass::Layered || layer_block_.buffer) {
    upload(device, "layer_block", layer_entries_, layer_block_);
  }
}

}  // namespace gnomon::render_scene
