// SPDX-License-Identifier: MIT
#pragma once

#include "render_scene.hh"

#include "draw_pass.hh"

#include <array>

/** What a class of materials needs of meshes and shading groups. For engines. */
namespace gnomon::render_scene {

/** What a group reads of each of scene::texture_inputs; names nothing where it reads none. */
using TextureSet = std::array<scene::Handle<scene::Texture>, scene::texture_inputs.size()>;

[[nodiscard]] MeshStreams streams_of(MaterialClass material_class);

/** The textures that a program of \a material_class reads, as far as they can be drawn. */
[[nodiscard]] TextureSet textures_of(const scene::Scene &scene, const scene::Mesh &mesh, MaterialClass material_class);

/** What a program reads that tells where a surface is cut out: nothing, or a texture and vertex colours. */
[[nodiscard]] MaterialClass mask_class(const scene::Scene &scene, const scene::Mesh &mesh);

/** Bind the textures of \a set that a program of \a material_class reads. */
void bind_textures(draw::ShadingGroup &group, RenderScene &scene, MaterialClass material_class, const TextureSet &set);

}  // namespace gnomon::render_scene
