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

render_scene::MeshStreams streams_of(MaterialClass material_class)
{
  switch (material_class) {
    case MaterialClass::BaseColor: return render_scene::MeshStreams::Uvs;
    case MaterialClass::Full: return render_scene::MeshStreams::All;
    default: return render_scene::MeshStreams::Shape;
  }
}

TextureSet textures_of(const scene::Scene &scene, const scene::Mesh &mesh, bool is_base_color_only)
{
  const scene::Material &material = scene.material_of(mesh);
  TextureSet set;
  for (std::size_t i = 0; i < (is_base_color_only ? 1 : set.size()); i++) {
    const scene::TextureSlot &slot = material.*scene::texture_inputs[i].slot;
    set[i] = render_scene::is_drawable(scene, slot.texture) ? slot.texture : scene::Handle<scene::Texture>();
  }
  return set;
}

MaterialClass mask_class(const scene::Scene &scene, const scene::Mesh &mesh)
{
  return render_scene::is_masked(scene, mesh) ? render_scene::material_class(scene, mesh) : MaterialClass::Plain;
}

Feature mask_features(MaterialClass mask_class)
{
  return mask_class == MaterialClass::Plain  ? Feature::None
         : mask_class == MaterialClass::Full ? Feature::AlphaMask | Feature::FullMaterial
                                             : Feature::AlphaMask;
}

}  // namespace gnomon::eevee
