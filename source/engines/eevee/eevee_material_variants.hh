// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_features.hh"

#include "render_surfaces.hh"

/** What a class of materials needs of programs. For the engine's own files. */
namespace gnomon::eevee {

[[nodiscard]] Feature feature_of(render_scene::MaterialClass material_class);
/** For programs that only cut out. */
[[nodiscard]] Feature mask_features(render_scene::MaterialClass mask_class);

}  // namespace gnomon::eevee
