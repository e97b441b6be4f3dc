// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_engine_data.hh"
#include "eevee_features.hh"

#include "render_scene.hh"

/** What a class of materials needs of programs, meshes and groups. For the engine's own files. */
namespace gnomon::eevee {

[[nodiscard]] Feature feature_of(render_scene::MaterialClass material_class);
[[nodiscard]] render_scene::MeshStreams streams_of(render_scene::MaterialClass material_class);

/** The textures that can be drawn, of the base colour alone, or of all inputs. */
[[nodiscard]] TextureSet textures_of(const scene::Scene &scene, const scene::Mesh &mesh, bool is_base_color_only);

/** What a program reads that tells where a surface is cut out: nothing, or a texture and vertex colours. */
[[nodiscard]] render_scene::MaterialClass mask_class(const scene::Scene &scene, const scene::Mesh &mesh);
/** For programs that only cut out. */
[[nodiscard]] Feature mask_features(render_scene::MaterialClass mask_class);

}  // namespace gnomon::eevee
