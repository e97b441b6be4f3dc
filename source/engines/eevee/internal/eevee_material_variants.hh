// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_features.hh"

#include "render_surfaces.hh"

/** Program features that a class of materials needs. Internal to the engine. */
namespace gnomon::eevee {

/** The feature of programs that shade a material. */
[[nodiscard]] Feature feature_of(render_scene::MaterialClass material_class);
/** The features of programs that only apply the alpha mask (depth and shadow passes). */
[[nodiscard]] Feature mask_features(render_scene::MaterialClass mask_class);

/** Whether the scene has a material that may be blended or that transmits light: depth_prepass does not draw these. */
[[nodiscard]] bool has_surfaces_without_depth(const scene::Scene &scene);

}  // namespace gnomon::eevee
