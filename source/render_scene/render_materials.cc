// SPDX-License-Identifier: MIT
#include "render_materials.hh"

#include "render_images.hh"

#include "eevee_bsdf_shared.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cstring>

namespace gnomon::render_scene {

bool is_drawable(const scene::Material &material)
{
  return material.alpha_mode != scene::AlphaMode::Mask || material.alpha >= material.alpha_cutoff;
}

bool is_textured(const scene::Scene &scene, const scene::Mesh &mesh)
{
  return !mesh.uvs.empty() && is_drawable(scene, scene.material_of(mesh).base_color_texture);
}

bool is_masked(const scene::Scene &scene, const scene::Material &material)
{
  return material.alpha_mode == scene::AlphaMode::Mask && is_drawable(scene, material.base_color_texture) &&
         is_drawable(material) && material.alpha_cutoff > 0.0F;
}

shared::MaterialData material_data(const scene::Material &material, bool is_masked)
{
  // glTF 2.0, appendix B, and KHR_materials_specular; 0.04 is a dielectric of index 1.5.
  constexpr float dielectric_f0 = 0.04F;
  const glm::vec3 dielectric = glm::min(dielectric_f0 * material.specular_color, glm::vec3(1.0F)) * material.specular;
  shared::MaterialData data{};
  data.diffuse = material.base_color * (1.0F - material.metallic);
  data.alpha = std::max(material.roughness * material.roughness, shared::ALPHA_MIN);
  data.specular_f0 = glm::mix(dielectric, material.base_color, material.metallic);
  data.specular_f90 = shared::grazing_reflection(data.specular_f0);
  data.emissive = material.emissive;
  data.metal_f0 = material.base_color * material.metallic;
  if (is_masked) {
    data.mask_cutoff = material.alpha_cutoff / material.alpha;
  }
  return data;
}

std::uint32_t MaterialTable::place_of(const scene::Scene &scene, scene::Handle<scene::Material> material)
{
  return scene.materials().is_live(material) ? material.index + 1 : 0;
}

void MaterialTable::update(const scene::Scene &scene)
{
  const scene::Pool<scene::Material> &materials = scene.materials();
  // A removed image changes which materials are masked.
  const scene::Revision latest =
      std::max({materials.latest(), scene.textures().latest(), scene.images().latest(scene::Image::Aspect::Content)});
  if (!entries_.empty() && latest == seen_) {
    return;
  }
  std::vector<shared::MaterialData> entries(materials.index_end() + 1, material_data({}, false));
  for (const auto &[handle, material] : materials) {
    entries[handle.index + 1] = material_data(material, is_masked(scene, material));
  }
  for (std::size_t place = 0; place < entries.size(); place++) {
    const bool is_same =
        place < entries_.size() && std::memcmp(&entries[place], &entries_[place], sizeof(shared::MaterialData)) == 0;
    if (!is_same) {
      changed_begin_ = std::min(changed_begin_, place);
      changed_end_ = std::max(changed_end_, place + 1);
    }
  }
  entries_ = std::move(entries);
  seen_ = latest;
}

void MaterialTable::upload(gpu::Device &device)
{
  const auto bytes = std::as_bytes(std::span(entries_));
  if (!buffer_ || buffer_.size_bytes() != bytes.size()) {
    buffer_ = device.create_buffer({"material_block", gpu::BufferKind::Storage, bytes.size()});
    changed_begin_ = 0;
    changed_end_ = entries_.size();
  }
  if (changed_begin_ < changed_end_) {
    constexpr std::size_t entry_bytes = sizeof(shared::MaterialData);
    device.update(buffer_, changed_begin_ * entry_bytes,
                  bytes.subspan(changed_begin_ * entry_bytes, (changed_end_ - changed_begin_) * entry_bytes));
    changed_begin_ = entries_.size();
    changed_end_ = 0;
  }
}

}  // namespace gnomon::render_scene
