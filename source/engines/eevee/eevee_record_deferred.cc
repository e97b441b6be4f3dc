// SPDX-License-Identifier: MIT
// Deferred lighting: which objects it lights, and the pass that lights their pixels.
#include "eevee_engine.hh"
#include "eevee_engine_data.hh"
#include "eevee_gbuffer_shared.h"
#include "eevee_material_variants.hh"

namespace gnomon::eevee {

/**
 * Whether the G-buffer can hold the inputs of a surface's lighting: the surface is opaque and has no textures or other
 * inputs.
 */
static bool allows_deferred(const scene::Scene &scene, const scene::Mesh &mesh)
{
  return render_scene::MaterialTable::place_of(scene, mesh.material) <= shared::GBUFFER_MATERIAL_MAX &&
         render_scene::material_class(scene, mesh) == render_scene::MaterialClass::Plain &&
         !render_scene::has_surface_function(scene, scene.material_of(mesh)) && !render_scene::is_blended(scene, mesh);
}

bool Engine::is_scene_deferred(Feature features) const
{
  if (!has(features, Feature::Light) || has(features, Feature::ShadowEsm)) {
    return false;
  }
  const scene::Scene &scene = scene_.scene();
  std::size_t allowed = 0;
  for (const auto &[handle, mesh] : scene.meshes()) {
    allowed += allows_deferred(scene, mesh) ? 1 : 0;
  }
  return 2 * allowed >= scene.meshes().size();
}

bool Engine::is_lit_deferred(const StorageList &stl, const render_scene::RenderObject &object) const
{
  const scene::Scene &scene = scene_.scene();
  return stl.is_deferred && object.receives_shadow && allows_deferred(scene, scene.meshes()[object.mesh]);
}

void Engine::record_deferred_lit(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  draw::ShadingGroup &group = data.psl->deferred_lit_pass.group(
      shaders_->get(viewport.device(), ShaderId::DeferredLit, with_variant(data.stl.features | asked_features())));
  bind_lit(group, data);
  group.bind_texture("gbuffer", data.txl.radiance, data.txl.nearest);
  group.call_procedural();
}

}  // namespace gnomon::eevee
