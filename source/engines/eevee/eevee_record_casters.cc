// SPDX-License-Identifier: MIT
// Records the pass that draws shadow casters, and gives the list of casters to SceneShadows.
#include "eevee_engine.hh"
#include "eevee_engine_data.hh"
#include "eevee_material_variants.hh"
#include "eevee_surface_functions.hh"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace gnomon::eevee {

namespace {

using gpu::State;
using render_scene::MaterialClass;
using render_scene::TextureSet;

ShaderId shadow_shader(LayerPass layer_pass)
{
  switch (layer_pass) {
    case LayerPass::Layered: return ShaderId::ShadowLayered;
    case LayerPass::Geometry: return ShaderId::ShadowGeometry;
    default: return ShaderId::Shadow;
  }
}

State culled_state(CasterFaces faces)
{
  switch (faces) {
    case CasterFaces::Front: return State::CullBack;
    case CasterFaces::Back: return State::CullFront;
    default: return State::None;
  }
}

/** Hash of all values that the shadow of a caster of \a handle depends on, except its matrix. */
std::uint64_t mesh_fingerprint(const render_scene::RenderScene &render_scene, scene::Handle<scene::Mesh> handle)
{
  const scene::Scene &scene = render_scene.scene();
  const scene::Mesh &mesh = scene.meshes()[handle];
  const scene::Material &material = scene.material_of(mesh);
  struct {
    std::uint64_t mesh;
    scene::Revision shape;
    std::uint64_t host_shape;
    std::uint64_t is_double_sided;
    std::uint64_t alpha_mode;
    std::uint64_t texture;
    scene::Revision image_of_texture;
    scene::Revision sampler;
    scene::Revision content;
    std::uint64_t host_content;
    glm::vec2 uv_offset;
    glm::vec2 uv_scale;
    float uv_rotation;
    int uv_set;
    float alpha;
    float alpha_cutoff;
    glm::vec4 transmitted;
    /** The surface function, the revision of all that it may read, and the origin of its positions. */
    std::uint64_t function;
    scene::Revision function_inputs;
    std::uint64_t host_inputs;
    glm::dvec3 origin_ws;
  } key{};
  key.mesh = handle.key();
  key.shape = scene.meshes().revision(handle, scene::Mesh::Aspect::Shape);
  key.host_shape = render_scene.meshes().host_batches().content_revision(handle);
  key.is_double_sided = material.is_double_sided ? 1 : 0;
  if (render_scene::is_masked(scene, mesh) || render_scene::lets_light_through(scene, mesh)) {
    key.alpha_mode = std::uint64_t(material.alpha_mode);
    const scene::TextureSlot &slot = material.base_color_texture;
    if (render_scene::is_drawable(scene, mesh, slot)) {
      key.texture = slot.texture.key();
      key.image_of_texture = scene.textures().revision(slot.texture, scene::Texture::Aspect::Image);
      key.sampler = scene.textures().revision(slot.texture, scene::Texture::Aspect::Sampler);
      const scene::Handle<scene::Image> image = scene.textures()[slot.texture].image;
      key.content = scene.images().revision(image, scene::Image::Aspect::Content);
      key.host_content = render_scene.images().host_textures().content_revision(image);
      key.uv_offset = slot.offset;
      key.uv_scale = slot.scale;
      key.uv_rotation = slot.rotation;
      key.uv_set = slot.uv_set;
    }
    key.alpha = material.alpha;
    key.alpha_cutoff = material.alpha_cutoff;
    if (material.has_transmission()) {
      key.transmitted = {material.base_color, render_scene::transmitted_part(material)};
    }
    key.function = alpha_function_of(scene, material).key;
    if (key.function != 0) {
      key.function_inputs = std::max({scene.materials().latest(), scene.textures().latest(), scene.images().latest()});
      key.host_inputs = render_scene.images().host_textures().revision();
      key.origin_ws = render_scene.origin_ws();
    }
  }
  return fingerprint_of(std::as_bytes(std::span(&key, 1)));
}

/** All that the shadow of a caster depends on. */
struct CasterKey {
  glm::mat4 world_from_object;
  /** \see mesh_fingerprint */
  std::uint64_t mesh;
};

std::uint64_t caster_fingerprint(const CasterKey &key)
{
  return fingerprint_of(std::as_bytes(std::span(&key, 1)));
}

}  // namespace

/** Record the pass that draws casters if one of its inputs changed. */
void Engine::record_casters(Data &data)
{
  SharedData &shared = *data.shared;
  const CastersKey key{scene_.objects().structure_revision(), scene_.passes_revision(), settings_revision_,
                       shaders_->revision(), has(data.stl.features, any_shadow)};
  const draw::ObjectBuffer &objects = scene_.objects();
  const bool is_winding_kept = std::ranges::none_of(data.stl.objects, [&](draw::ObjectIndex index) {
    return index < shared.is_mirrored.size() && shared.is_mirrored[index] != objects.is_mirrored(index);
  });
  if (shared.recorded == key && is_winding_kept) {
    return;
  }
  shared.recorded.reset();
  shared.shadow_pass.clear();
  shared.groups.clear();
  shared.caster_kinds.clear();
  shared.caster_kind_of.assign(objects.index_end(), 0);
  shared.is_mirrored.assign(objects.index_end(), false);
  // By mesh and winding: the number of the kind, from 1. 0: there is none yet.
  std::vector<std::array<std::uint32_t, 2>> numbers(scene_.scene().meshes().index_end());
  for (const draw::ObjectIndex index : data.stl.objects) {
    const render_scene::RenderObject &object = scene_.object(index);
    const bool is_mirrored = objects.is_mirrored(index);
    shared.is_mirrored[index] = is_mirrored;
    if (!key.has_shadows || !object.casts_shadow) {
      continue;
    }
    std::uint32_t &number = numbers[object.mesh.index][is_mirrored ? 1 : 0];
    if (number == 0) {
      shared.caster_kinds.push_back(record_caster_kind(shared, index));
      number = std::uint32_t(shared.caster_kinds.size());
    }
    shared.caster_kind_of[index] = number;
  }
  shared.recorded = key;
}

CasterKind Engine::record_caster_kind(SharedData &shared, draw::ObjectIndex first)
{
  const scene::Handle<scene::Mesh> handle = scene_.object(first).mesh;
  const scene::Scene &scene = scene_.scene();
  const scene::Mesh &mesh = scene.meshes()[handle];
  if (mesh.topology != scene::Topology::Triangles) {
    return {.handle = handle};
  }
  const scene::Material &material = scene.material_of(mesh);
  const bool is_open = render_scene::lets_light_through(scene, mesh);
  const MaterialClass cut_out = is_open ? MaterialClass::Full : render_scene::mask_class(scene, mesh);
  const State winding = shared.is_mirrored[first] ? State::FrontClockwise : State::None;
  const FunctionText function = cut_out == MaterialClass::Plain ? FunctionText() : alpha_function_of(scene, material);
  const gpu::Shader &shader =
      shaders_->get(scene_.device(), shadow_shader(shared.shadows.layer_pass()),
                    mask_features(cut_out) | (is_open ? Feature::OpacityThreshold : Feature::None), function);
  const State faces = material.is_double_sided ? State::None : culled_state(settings_.shadow.caster_faces);
  // Without culling the winding has no effect.
  const State state = faces == State::None ? State::None : faces | winding;
  const TextureSet textures =
      cut_out == MaterialClass::Plain
          ? TextureSet()
          : textures_of(scene, mesh, function.key != 0 ? MaterialClass::Full : MaterialClass::BaseColor);
  draw::ShadingGroup *&group = shared.groups[{&shared.shadow_pass, shader.id(), state, textures}];
  if (!group) {
    group = &shared.shadow_pass.group(shader);
    group->state_enable(state);
    group->bind_storage_ref("object_block", &shared.object_block);
    group->bind_storage_ref("material_block", &shared.material_block);
    group->bind_storage_ref("full_material_block", &shared.full_material_block);
    group->bind_uniform_ref("shadow_render_block", shared.shadows.render_block());
    if (function.key != 0) {
      group->bind_uniform("surface_function_block", shared.surface_function_block);
    }
    group->constant_ref("sample_index", &shared.sample_index);
    group->constant_ref("sample_seed", &shared.sample_seed);
    render_scene::bind_textures(*group, scene_, cut_out, textures);
  }
  return {.handle = handle, .instances = &group->instances(scene_.batch(handle, streams_of(cut_out)))};
}

/** Give the current casters to SceneShadows, which compares them with those of the last sync. */
void Engine::add_casters(Data &data)
{
  SharedData &shared = *data.shared;
  const draw::ObjectBuffer &objects = scene_.objects();
  std::vector<std::pair<const scene::Mesh *, std::uint64_t>> meshes;
  meshes.reserve(shared.caster_kinds.size());
  for (CasterKind &kind : shared.caster_kinds) {
    const scene::Mesh &mesh = scene_.scene().meshes()[kind.handle];
    meshes.emplace_back(mesh.host_shape ? nullptr : &mesh, mesh_fingerprint(scene_, kind.handle));
    kind.is_blended = render_scene::lets_light_through(scene_.scene(), mesh);
  }
  for (const draw::ObjectIndex index : data.stl.objects) {
    const std::uint32_t number = shared.caster_kind_of[index];
    if (number == 0 || shared.caster_kinds[number - 1].instances == nullptr) {
      continue;
    }
    const CasterKind &kind = shared.caster_kinds[number - 1];
    const auto &[mesh, mesh_print] = meshes[number - 1];
    const glm::mat4 &world_from_object = objects.world_from_object(index);
    const std::uint64_t fingerprint = caster_fingerprint({world_from_object, mesh_print});
    shared.shadows.add_caster(
        {scene_.object(index).bounds, index, kind.instances, fingerprint, mesh, &world_from_object, kind.is_blended});
  }
  shared.shadows.finish();
  shared.has_casters = true;
}

}  // namespace gnomon::eevee
