// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_features.hh"

#include "eevee_material_shared.h"

namespace gnomon::eevee {

[[nodiscard]] shared::MaterialData material_data(const scene::Material &material);

/** One entry a material of the scene, in its order. */
[[nodiscard]] std::vector<shared::MaterialData> make_materials(const scene::Scene &scene);

/** Feature::Specular where any of them reflects specularly. */
[[nodiscard]] Feature material_features(const std::vector<shared::MaterialData> &materials);

}  // namespace gnomon::eevee
