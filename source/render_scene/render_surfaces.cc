// SPDX-License-Identifier: MIT
#include "render_surfaces.hh"

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

TextureSet textures_of(const scene::Scene &scene, const scene::Mesh &mesh, MaterialClass material_class)
{
  const scene::Material &material = scene.material_of(mesh);
  TextureSet set;
  for (std::size_t i = 0; i < input_count(material_class); i++) {
    const scene::TextureSlot &slot = material.*scene::texture_inputs[i].slot;
    set[i] = is_drawable(scene, slot.texture) ? slot.texture : scene::Handle<scene::Texture>();
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
    const auto [image, sampler] = scene.texture(set[i], input.is_color);
    group.bind_texture(input.name, image, sampler);
  }
}

}  // namespace gnomon::render_scene
