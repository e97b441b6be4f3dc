// SPDX-License-Identifier: MIT
#pragma once

#include "render_materials.hh"

#include "draw_pass.hh"

#include <array>
#include <compare>

/** The vertex streams and textures that shading groups need for each MaterialClass. For engines. */
namespace gnomon::render_scene {

/** The textures of a group, one for each of scene::texture_inputs. */
struct TextureSet {
  /** An empty handle means that there is no texture. */
  std::array<scene::Handle<scene::Texture>, scene::texture_inputs.size()> textures{};
  /** The use of that of the base colour, by use_of(). */
  scene::ImageUse base_color_use = scene::ImageUse::Color;
  /** Limit for the alpha of the base colour texture; 0: it is no mask. */
  float mask_cutoff = 0.0F;

  auto operator<=>(const TextureSet &) const = default;
};

/** The use of the image of a slot, which is drawable. An image without alpha does not count as coverage. */
[[nodiscard]] scene::ImageUse use_of(const scene::Scene &scene, const scene::Material &material,
                                     const scene::TextureInput &input);

/** The vertex streams that shaders of \a material_class read. */
[[nodiscard]] MeshStreams streams_of(MaterialClass material_class);

/** The drawable textures of the mesh's material that shaders of \a material_class read. */
[[nodiscard]] TextureSet textures_of(const scene::Scene &scene, const scene::Mesh &mesh, MaterialClass material_class);

/** The class for depth passes: material_class(), at most Full, if the surface is masked; otherwise Plain. */
[[nodiscard]] MaterialClass mask_class(const scene::Scene &scene, const scene::Mesh &mesh);

/** The bits of the state that draws a mesh of this topology. */
[[nodiscard]] constexpr gpu::State topology_state(scene::Topology topology)
{
  return topology == scene::Topology::Lines    ? gpu::State::DrawLines
         : topology == scene::Topology::Points ? gpu::State::DrawPoints
                                               : gpu::State::None;
}

/** Bind the textures of \a set that shaders of \a material_class read. Missing textures are white. */
void bind_textures(draw::ShadingGroup &group, RenderScene &scene, MaterialClass material_class, const TextureSet &set);

}  // namespace gnomon::render_scene
