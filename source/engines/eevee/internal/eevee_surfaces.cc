// SPDX-License-Identifier: MIT
#include "internal/eevee_surfaces.hh"

#include "internal/eevee_material_variants.hh"
#include "internal/eevee_surface_functions.hh"

namespace gnomon::eevee {

using gpu::State;
using render_scene::MaterialClass;
using render_scene::TextureSet;

SurfacePasses::SurfacePasses(draw::ObjectBuffer &objects, const RenderBuffers &buffers, DepthPasses &depth,
                             Transmission &transmission, BlendPass &blend, SurfaceProbe &probe)
    : buffers_(buffers),
      depth_(depth),
      transmission_(transmission),
      blend_(blend),
      probe_(probe),
      pass_("lit_pass", State::WriteColor | State::DepthEqual, &objects),
      tint_pass_("tint_pass", State::WriteColor | State::DepthEqual | State::BlendMultiply, &objects)
{
}

void SurfacePasses::begin_sync(std::size_t object_count)
{
  objects_.clear();
  objects_.reserve(object_count);
  is_collecting_ = are_objects_changed_ = true;
}

void SurfacePasses::sync(draw::ObjectIndex object, bool is_mirrored)
{
  if (is_collecting_) {
    objects_.push_back(object);
  }
  else if (object < is_mirrored_.size()) {
    are_objects_changed_ |= is_mirrored_[object] != is_mirrored;
  }
}

void SurfacePasses::end_sync()
{
  is_collecting_ = false;
}

void SurfacePasses::update(render_scene::RenderScene &scene, ShaderCache &shaders, const SurfaceInputs &inputs,
                           const BindLit &bind)
{
  if (recorded_ == inputs && !are_objects_changed_) {
    return;
  }
  recorded_.reset();
  recording_count_++;
  free_surface_functions(shaders, scene.scene());
  record({scene, shaders, inputs, bind});
  are_objects_changed_ = false;
  recorded_ = inputs;
}

void SurfacePasses::record(const Recording &recording)
{
  render_scene::RenderScene &scene = recording.scene;
  const draw::ObjectBuffer &objects = scene.objects();
  depth_.clear(scene.scene(), recording.inputs.features);
  transmission_.clear();
  blend_.clear();
  probe_.clear();
  pass_.clear();
  tint_pass_.clear();
  groups_.clear();
  is_mirrored_.assign(objects.index_end(), false);
  std::vector<Kind> kinds;
  // By mesh and by the properties in which its objects differ: the number of the kind, from 1. 0: there is none yet.
  std::vector<std::array<std::uint32_t, 8>> numbers(scene.scene().meshes().index_end());
  for (const draw::ObjectIndex index : objects_) {
    const render_scene::RenderObject &object = scene.object(index);
    const bool is_mirrored = objects.is_mirrored(index);
    is_mirrored_[index] = is_mirrored;
    std::uint32_t &number = numbers[object.mesh.index][(is_mirrored ? 1 : 0) + (object.receives_shadow ? 2 : 0) +
                                                       (object.casts_shadow ? 4 : 0)];
    if (number == 0) {
      kinds.push_back(record_kind(recording, index));
      number = std::uint32_t(kinds.size());
    }
    const Kind &kind = kinds[number - 1];
    if (kind.blend_shader != nullptr) {
      blend_.add(scene, index, kind.batch, *kind.blend_shader, recording.bind);
    }
    for (std::size_t i = 0; i < kind.group_count; i++) {
      kind.groups[i]->call(kind.batch, index);
    }
  }
}

SurfacePasses::Kind SurfacePasses::record_kind(const Recording &recording, draw::ObjectIndex first)
{
  gpu::Device &device = recording.scene.device();
  const scene::Scene &scene = recording.scene.scene();
  const SurfaceInputs &inputs = recording.inputs;
  const Feature clip = inputs.is_clipped ? Feature::ClipPlanes : Feature::None;
  const render_scene::RenderObject &object = recording.scene.object(first);
  const scene::Mesh &mesh = scene.meshes()[object.mesh];
  const Feature shape = mesh.topology == scene::Topology::Triangles ? Feature::None : Feature::LinesOrPoints;
  const Feature features = inputs.features | shape;
  const scene::Material &material = scene.material_of(mesh);
  const MaterialClass cut_out = render_scene::mask_class(scene, mesh);
  const MaterialClass material_class = render_scene::material_class(scene, mesh);
  // Without light, the base colour has no effect on an opaque surface, except in Inspection::surfaces.
  const bool is_colorless = material_class == MaterialClass::BaseColor && cut_out == MaterialClass::Plain &&
                            !has(features, Feature::Light) && !inputs.has_surfaces;
  const MaterialClass surface = is_colorless ? MaterialClass::Plain : material_class;
  Kind kind{.batch = recording.scene.batch(object.mesh, streams_of(surface)).range()};
  const State fixed =
      (is_mirrored_[first] ? State::FrontClockwise : State::None) | render_scene::topology_state(mesh.topology);

  const FunctionText function = function_of(scene, material);
  const FunctionText alpha_function = cut_out == MaterialClass::Plain ? FunctionText() : function;
  const TextureSet alpha_textures =
      cut_out == MaterialClass::Plain
          ? TextureSet()
          : textures_of(scene, mesh, alpha_function.key != 0 ? MaterialClass::Full : MaterialClass::BaseColor);
  const TextureSet surface_textures = textures_of(scene, mesh, surface);
  const bool is_in_layers = object.casts_shadow && render_scene::has_closed_shadow(scene, mesh);
  const Feature shadowed = is_in_layers ? features : without(features, Feature::SurfaceInLayers);
  // An object that receives no shadows is drawn with a program without shadow lookups.
  const Feature lighting = (object.receives_shadow ? shadowed : without_shadows(features)) |
                           (function.key != 0 ? lit_function_features : Feature::None);
  const bool is_transmissive = surface == MaterialClass::Transmissive;
  // The G-buffer is lit by one program. An unlit surface looks up no layers.
  const bool is_deferred =
      depth_.is_deferred(scene, object) && (material.is_unlit || shadowed == features || !has(features, any_shadow));
  const bool is_blended = render_scene::is_blended(scene, mesh);
  const gpu::Shader *lit_shader =
      is_deferred || (is_transmissive && !inputs.has_behind)
          ? nullptr
          : &recording.shaders.get(device, ShaderId::Lit,
                                   with_variant(lighting | feature_of(surface) | (is_blended ? clip : Feature::None)),
                                   function);
  if (is_blended) {
    kind.blend_shader = lit_shader;
    return kind;
  }
  // The depth test of the lit pass is "equal": a back face at the depth of a front face of another triangle must be
  // culled.
  const State side = material.is_double_sided ? State::None : State::CullBack;
  const auto add = [&](draw::Pass &pass, const gpu::Shader &shader, State state, MaterialClass read,
                       const TextureSet &textures) {
    add_group(kind, recording, pass, shader, state | fixed, read, textures, recording.bind);
  };
  if (is_deferred) {
    add(depth_.gbuffer_pass(), recording.shaders.get(device, ShaderId::GBuffer, features | clip), side, surface, {});
  }
  else {
    draw::Pass &depth_pass = is_transmissive ? transmission_.depth_pass() : depth_.depth_pass(material.is_double_sided);
    const gpu::Shader &depth_shader =
        recording.shaders.get(device, alpha_function.key != 0 ? ShaderId::DepthFunction : ShaderId::Depth,
                              mask_features(cut_out) | clip | shape, alpha_function);
    add(depth_pass, depth_shader, is_transmissive ? side : State::None, cut_out, alpha_textures);
  }
  if (lit_shader) {
    add(is_transmissive ? transmission_.pass() : pass_, *lit_shader, side, surface, surface_textures);
  }
  record_inspection(kind, recording, {surface, surface_textures, function, lighting, shape, side | fixed});
  return kind;
}

void SurfacePasses::record_inspection(Kind &kind, const Recording &recording, const Inspected &inspected)
{
  gpu::Device &device = recording.scene.device();
  const SurfaceInputs &inputs = recording.inputs;
  const auto &[surface, textures, function, lighting, shape, state] = inspected;
  if (inputs.tinted_entry && surface != MaterialClass::Transmissive) {
    add_group(kind, recording, tint_pass_, recording.shaders.get(device, ShaderId::DebugCascades, inputs.features | shape),
              state, MaterialClass::Plain, {}, [&](draw::ShadingGroup &group) {
                recording.bind(group);
                group.constant("tinted_light", *inputs.tinted_entry);
              });
  }
  if (inputs.has_surfaces) {
    // The program reads normals also where nothing gives light.
    add_group(kind, recording, probe_.surfaces_pass(),
              recording.shaders.get(device, ShaderId::Surfaces, Feature::Light | feature_of(surface) | shape, function), state,
              surface, textures, recording.bind);
  }
  if (inputs.has_probe && has(inputs.features, Feature::Light)) {
    add_group(kind, recording, probe_.visibility_pass(), recording.shaders.get(device, ShaderId::Probe, lighting),
              state, MaterialClass::Plain, {}, [&](draw::ShadingGroup &group) {
                recording.bind(group);
                probe_.bind_light(group);
              });
  }
}

void SurfacePasses::add_group(Kind &kind, const Recording &recording, draw::Pass &pass, const gpu::Shader &shader,
                              State state, MaterialClass read, const TextureSet &textures, const BindLit &bind)
{
  draw::ShadingGroup *&group = groups_[{&pass, shader.id(), state, textures}];
  if (!group) {
    group = &pass.group(shader);
    group->state_enable(state);
    bind(*group);
    render_scene::bind_textures(*group, recording.scene, read, textures);
  }
  kind.groups[kind.group_count++] = group;
}

Need SurfacePasses::need(const FrameState &state) const
{
  return !state.is_seen                                                      ? Need{false, nothing_seen}
         : depth_.has_gbuffer() && pass_.is_empty() && tint_pass_.is_empty() ? Need{false, all_in_gbuffer}
                                                                             : Need{true, "objects in the view"};
}

FrameStep SurfacePasses::step()
{
  return {.name = "lit",
          .summary = "Shades each pixel of other objects once, by an equal-depth test.",
          .part = FrameStep::Part::Rows,
          .need = [this](const FrameState &state) { return need(state); },
          .reads = forward_reads(),
          .writes = {"radiance"},
          .passes = {{&pass_, "objects in the view",
                      [this](const FrameState &) { return depth_.has_gbuffer() ? all_in_gbuffer : nothing_seen; }},
                     {&tint_pass_, "asked for",
                      [](const FrameState &state) {
                        return !state.settings.has_cascade_tint ? "not asked for"
                               : state.has_tinted_light         ? nothing_seen
                                                                : "no sun has a shadow";
                      }}},
          .record =
              [this](FrameSample &sample, gpu::CommandList &list) {
                record_pass(sample, list, buffers_.main_fb,
                            {.color_load = depth_.has_gbuffer() ? gpu::LoadAction::Load : gpu::LoadAction::Clear,
                             .depth_load = gpu::LoadAction::Load,
                             .scissor = sample.read_region()});
              }};
}

}  // namespace gnomon::eevee
