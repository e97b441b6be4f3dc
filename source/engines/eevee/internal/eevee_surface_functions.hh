// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_shaders.hh"

#include "eevee_surface_function_shared.h"
#include "render_scene.hh"

/** Surface functions of materials. Internal to the engine. */
namespace gnomon::eevee {

/** Features of lit programs with a surface function: they read normals, and the surface may reflect. */
inline constexpr Feature lit_function_features = Feature::Light | Feature::Specular;

/** The surface function of \a material, which is one of \a scene, for ShaderCache::get. */
[[nodiscard]] FunctionText function_of(const scene::Scene &scene, const scene::Material &material);

/**
 * The same for passes that draw depths: no function if it cannot change which parts of the surface exist, because the
 * material is opaque.
 */
[[nodiscard]] FunctionText alpha_function_of(const scene::Scene &scene, const scene::Material &material);

/** Create `surface_function_block` and write \a data, or destroy it if \a is_needed is false. */
void update_surface_functions(gpu::Buffer &block, gpu::Device &device, bool is_needed,
                              const shared::SurfaceFunctionData &data);

/** Destroy the programs of functions that no material names any more. */
void free_surface_functions(ShaderCache &shaders, const scene::Scene &scene);

/** A line for each function that is broken, which names the first material with it and counts the others. */
[[nodiscard]] std::vector<std::string> surface_function_warnings(const scene::Scene &scene, const ShaderCache &shaders);

}  // namespace gnomon::eevee
