// SPDX-License-Identifier: MIT
#include "eevee_materials.hh"

#include "eevee_bsdf_shared.h"

#include <algorithm>

namespace gnomon::eevee {

bool is_seen(const scene::Material &material)
{
  return material.alpha_mode != scene::AlphaMode::Mask || material.alpha >= material.alpha_cutoff;
}

bool is_masked(const scene::Material &material)
{
  return material.alpha_mode == scene::AlphaMode::Mask && material.base_color_texture >= 0 && is_seen(material) &&
         material.alpha_cutoff > 0.0F;
}

shared::MaterialData material_data(const scene::Material &material)
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
  if (is_masked(material)) {
    data.mask_cutoff = material.alpha_cutoff / material.alpha;
  }
  return data;
}

std::vector<shared::MaterialData> make_materials(const scene::Scene &scene)
{
  std::vector<shared::MaterialData> materials;
  materials.reserve(scene.materials.size());
  for (const scene::Material &material : scene.materials) {
    materials.push_back(material_data(material));
  }
  return materials;
}

Feature material_features(const std::vector<shared::MaterialData> &materials)
{
  const bool is_specular =
      std::ranges::any_of(materials, [](const auto &material) { return material.specular_f90 > 0.0F; });
  return is_specular ? Feature::Specular : Feature::None;
}

}  // namespace gnomon::eevee
