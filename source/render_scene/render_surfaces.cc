// SPDX-License-Identifier: MIT
#include "render_surfaces.hh"

#include "scene_image.hh"

#include <algorithm>

namespace gnomon::render_scene {

/** Number of texture inputs that shaders of the class read. They are the first ones of scene::texture_inputs. */
static std::size_t input_count(MaterialClass material_class)
{
  switch (material_class) {
    case MaterialClass::BaseColor: return 1;
    case MaterialClass::Full: return FULL_TEXTURE_COUNT;
    case MaterialClass::Layered: return FULL_TEXTURE_COUNT + LAYER_TEXTURE_COUNT;
    case MaterialClass::Transmissive: return scene::texture_inputs.size();
    default: return 0;
  }
}

MeshStreams streams_of(MaterialClass material_class)
{
  switch (material_class) {
    case MaterialClass::BaseColor: return MeshStreams::Uvs;
    case MaterialClass::Full:
    case MaterialClass::Layered:
    case MaterialClass::Transmissive: return MeshStreams::All;
    default: return MeshStreams::Shape;
  }
}

scene::ImageUse use_of(const scene::Scene &scene, const scene::Material &material, const scene::TextureInput &input)
{
  const scene::ImageUse use = scene::use_of(material, input);
  const bool is_opaque = (use == scene::ImageUse::Coverage || use == scene::ImageUse::Mask) &&
                         scene.images()[scene.textures()[(material.*input.slot).texture].image].is_opaque;
  return is_opaque ? scene::ImageUse::Color : use;
}

TextureSet textures_of(const scene::Scene &scene, const scene::Mesh &mesh, MaterialClass material_class)
{
  const scene::Material &material = scene.material_of(mesh);
  TextureSet set;
  for (std::size_t i = 0; i < input_count(material_class); i++) {
    const scene::TextureInput &input = scene::texture_inputs[i];
    const scene::Handle<scene::Texture> texture = (material.*input.slot).texture;
    if (is_drawable(scene, texture)) {
      set.textures[i] = texture;
      if (input.slot == &scene::Material::base_color_texture) {
        set.base_color_use = use_of(scene, material, input);
        set.mask_cutoff = set.base_color_use == scene::ImageUse::Mask ? material_data(material).mask_cutoff : 0.0F;
      }
    }
  }
  return set;
}

MaterialClass mask_class(const scene::Scene &scene, const scene::Mesh &mesh)
{
  return is_masked(scene, mesh) ? std::min(material_class(scene, mesh), MaterialClass::Full) : MaterialClass::Plain;
}

void bind_textures(draw::ShadingGroup &group, RenderScene &scene, MaterialClass material_class, const TextureSet &set)
{
  for (std::size_t i = 0; i < input_count(material_class); i++) {
    const scene::TextureInput &input = scene::texture_inputs[i];
    const bool is_base_color = input.slot == &scene::Material::base_color_texture;
    const scene::ImageUse use = is_base_color    ? set.base_color_use
                                : input.is_color ? scene::ImageUse::Color
                                                 : scene::ImageUse::Data;
    const auto [image, sampler] = scene.texture(set.textures[i], use, is_base_color ? set.mask_cutoff : 0.0F);
    group.bind_texture(input.name, image, sampler);
  }
}

}  // namespace gnomon::render_scene
