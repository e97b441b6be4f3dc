// SPDX-License-Identifier: MIT
#include "internal/eevee_material_variants.hh"

namespace gnomon::eevee {

using render_scene::MaterialClass;

Feature feature_of(MaterialClass material_class)
{
  switch (material_class) {
    case MaterialClass::BaseColor: return Feature::BaseColorTexture;
    case MaterialClass::Full: return Feature::FullMaterial;
    case MaterialClass::Layered: return Feature::FullMaterial | Feature::Layers;
    case MaterialClass::Transmissive: return Feature::FullMaterial | Feature::Layers | Feature::Transmission;
    default: return Feature::None;
  }
}

Feature mask_features(MaterialClass mask_class)
{
  return mask_class == MaterialClass::Plain  ? Feature::None
         : mask_class == MaterialClass::Full ? Feature::AlphaMask | Feature::FullMaterial
                                             : Feature::AlphaMask;
}

bool has_surfaces_without_depth(const scene::Scene &scene)
{
  for (const auto &[handle, material] : scene.materials()) {
    if (material.alpha_mode == scene::AlphaMode::Blend || material.has_transmission()) {
      return true;
    }
  }
  return false;
}

}  // namespace gnomon::eevee
