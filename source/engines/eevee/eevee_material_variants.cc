// SPDX-License-Identifier: MIT
#include "eevee_material_variants.hh"

namespace gnomon::eevee {

using render_scene::MaterialClass;

Feature feature_of(MaterialClass material_class)
{
  switch (material_class) {
    case MaterialClass::BaseColor: return Feature::BaseColorTexture;
    case MaterialClass::Full: return Feature::FullMaterial;
    default: return Feature::None;
  }
}

Feature mask_features(MaterialClass mask_class)
{
  return mask_class == MaterialClass::Plain  ? Feature::None
         : mask_class == MaterialClass::Full ? Feature::AlphaMask | Feature::FullMaterial
                                             : Feature::AlphaMask;
}

}  // namespace gnomon::eevee
