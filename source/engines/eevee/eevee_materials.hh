// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_features.hh"

#include "scene.hh"

#include "eevee_material_shared.h"

namespace gnomon::eevee {

/** Whether any of it can be above the cutoff; a texture's alpha is at most 1. */
[[nodiscard]] bool is_seen(const scene::Material &material);

/** Whether a texture may cut some of it out: it takes a lookup to tell. */
[[nodiscard]] bool is_masked(const scene::Material &material);

[[nodiscard]] shared::MaterialData material_data(const scene::Material &material);

/** One entry a material of the scene, in its order. */
[[nodiscard]] std::vector<shared::MaterialData> make_materials(const scene::Scene &scene);

/** Feature::Specular where any of them reflects specularly. */
[[nodiscard]] Feature material_features(const std::vector<shared::MaterialData> &materials);

}  // namespace gnomon::eevee
