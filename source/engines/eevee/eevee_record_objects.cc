// SPDX-License-Identifier: MIT
// Records the passes that draw objects, except that of shadow casters.
#include "eevee_engine.hh"
#include "eevee_engine_data.hh"
#include "eevee_material_variants.hh"
#include "eevee_surface_functions.hh"

#include <array>
#include <vector>

namespace gnomon::eevee {

using gpu::State;
using render_scene::MaterialClass;
using render_scene::TextureSet;

void Engine::record_objects(draw::Viewport &viewport)
{
  Data &data = viewport.engine_data<Data>(*this);
  StorageList &stl = data.stl;
  const draw::ObjectBuffer &objects = scene_.objects();
  stl.is_mirrored.assign(objects.index_end(), false);
  std::vector<ObjectKind> kinds;
  // By mesh and by what differs between its objects: the number of the kind, from 1. 0: there is none yet.
  std::vector<std::array<std::uint32_t, 4>> numbers(scene_.scene().meshes().index_end());
  for (const draw::ObjectIndex index : stl.objects) {
    const render_scene::RenderObject &object = scene_.object(index);
    const bool is_mirrored = objects.is_mirrored(index);
    stl.is_mirrored[index] = is_mirrored;
    std::uint32_t &number = numbers[object.mesh.index][(is_mirrored ? 1 : 0) + (object.receives_shadow ? 2 : 0)];
    if (number == 0) {
      kinds.push_back(record_kind(viewport, index));
      number = std::uint32_t(kinds.size());
    }
    const ObjectKind &kind = kinds[number - 1];
    if (kind.blend_shader != nullptr) {
      record_blended(data, index, kind);
    }
    for (std::size_t i = 0; i < kind.group_count; i++) {
      kind.groups[i]->call(kind.batch, index);
    }
  }
}

ObjectKind Engine::record_kind(draw::Viewport &viewport, draw::ObjectIndex first)
{
  Data &data = viewport.engine_data<Data>(*this);
  StorageList &stl = data.stl;
  gpu::Device &device = viewport.device();
  const scene::Scene &scene = scene_.scene();
  const render_scene::RenderObject &object = scene_.object(first);
  const scene::Mesh &mesh = scene.meshes()[object.mesh];
  const scene::Material &material = scene.material_of(mesh);
  const MaterialClass cut_out = render_scene::mask_class(scene, mesh);
  const MaterialClass material_class = render_scene::material_class(scene, mesh);
  // Without light, the base colour has no effect on an opaque surface, except in Inspection::surfaces.
  const bool is_colorless = material_class == MaterialClass::BaseColor && cut_out == MaterialClass::Plain &&
                            !has(stl.features, Feature::Light) && !settings_.has_surfaces;
  const MaterialClass surface = is_colorless ? MaterialClass::Plain : material_class;
  ObjectKind kind{.batch = scene_.batch(object.mesh, streams_of(surface)).range()};
  const State winding = stl.is_mirrored[first] ? State::FrontClockwise : State::None;
  const State fixed = winding | render_scene::topology_state(mesh.topology);

  /** Adds a group of \a pass to the kind. \a bind binds the resources of a new group. */
  const auto add = [&](draw::Pass &pass, const gpu::Shader &shader, State state, MaterialClass read,
                       const TextureSet &textures, const auto &bind) {
    draw::ShadingGroup *&group = stl.groups[{&pass, shader.id(), state | fixed, textures}];
    if (!group) {
      group = &pass.group(shader);
      group->state_enable(state | fixed);
      bind(*group);
      render_scene::bind_textures(*group, scene_, read, textures);
    }
    kind.groups[kind.group_count++] = group;
  };
  const FunctionText function = function_of(scene, material);
  const FunctionText alpha_function = cut_out == MaterialClass::Plain ? FunctionText() : function;
  const TextureSet alpha_textures =
      cut_out == MaterialClass::Plain
          ? TextureSet()
          : textures_of(scene, mesh, alpha_function.key != 0 ? MaterialClass::Full : MaterialClass::BaseColor);
  const TextureSet surface_textures = textures_of(scene, mesh, surface);
  const auto bind_surface = [&data](draw::ShadingGroup &group) { bind_lit(group, data); };
  // An object that receives no shadows is drawn with a program without shadow lookups.
  const Feature lighting = (object.receives_shadow ? stl.features : without_shadows(stl.features)) |
                           (function.key != 0 ? lit_function_features : Feature::None);
  // Without the picture behind it, nothing that transmits light is in the view.
  const bool is_transmissive = surface == MaterialClass::Transmissive;
  const bool is_deferred = is_lit_deferred(stl, object);
  const gpu::Shader *lit_shader =
      is_deferred || (is_transmissive && !data.txl.behind)
          ? nullptr
          : &shaders_->get(device, ShaderId::Lit, with_variant(lighting | feature_of(surface) | asked_features()),
                           function);
  if (render_scene::is_blended(scene, mesh)) {
    kind.blend_shader = lit_shader;
    return kind;
  }
  // The depth test of the lit pass is "equal": a back face at the depth of a front face of another triangle must be
  // culled.
  const State side = material.is_double_sided ? State::None : State::CullBack;
  if (is_deferred) {
    add(data.psl->gbuffer_pass, shaders_->get(device, ShaderId::GBuffer, stl.features), side, surface, {},
        bind_surface);
  }
  else {
    draw::Pass &depth_pass = is_transmissive            ? data.psl->transmission_depth_pass
                             : material.is_double_sided ? data.psl->depth_pass
                                                        : data.psl->depth_pass_cull;
    const gpu::Shader &depth_shader =
        shaders_->get(device, alpha_function.key != 0 ? ShaderId::DepthFunction : ShaderId::Depth,
                      mask_features(cut_out), alpha_function);
    add(depth_pass, depth_shader, is_transmissive ? side : State::None, cut_out, alpha_textures, bind_surface);
  }
  if (lit_shader) {
    add(is_transmissive ? data.psl->transmission_pass : data.psl->lit_pass, *lit_shader, side, surface,
        surface_textures, bind_surface);
  }
  if (data.shared->tinted_light && !is_transmissive) {
    add(data.psl->tint_pass, shaders_->get(device, ShaderId::DebugCascades, stl.features), side, MaterialClass::Plain,
        {}, [&data](draw::ShadingGroup &group) {
          bind_lit(group, data);
          group.constant("tinted_light", light_entry(data, *data.shared->tinted_light, tinted_entry));
        });
  }
  if (settings_.has_surfaces) {
    // The program reads normals also where nothing gives light.
    add(data.psl->surfaces_pass,
        shaders_->get(device, ShaderId::Surfaces, Feature::Light | feature_of(surface), function), side, surface,
        surface_textures, bind_surface);
  }
  if (settings_.has_probe && has(stl.features, Feature::Light)) {
    add(data.psl->probe_pass, shaders_->get(device, ShaderId::Probe, lighting), side, MaterialClass::Plain, {},
        [&data](draw::ShadingGroup &group) {
          bind_lit(group, data);
          group.constant_ref("probed_light", &data.stl.probed_light);
        });
  }
  return kind;
}

}  // namespace gnomon::eevee
