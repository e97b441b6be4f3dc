// SPDX-License-Identifier: MIT
#include "internal/eevee_shadow_pass.hh"

#include "eevee_camera.hh"
#include "internal/eevee_material_variants.hh"
#include "internal/eevee_surface_functions.hh"
#include "shadows/shadow_casters.hh"
#include "shadows/shadows.hh"

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
  if (render_scene::is_masked(scene, mesh) || render_scene::has_open_shadow(scene, mesh)) {
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

ShadowPass::ShadowPass(draw::ObjectBuffer &objects, const SceneMaterials &materials, SceneShadows &shadows)
    : materials_(materials),
      shadows_(shadows),
      pass_("shadow_pass", State::WriteDepth | State::DepthNearerEqual | State::DepthClamp, &objects)
{
}

bool ShadowPass::set_sample(int index, std::uint32_t seed)
{
  const bool is_index_kept = std::exchange(sample_index_, index) == index;
  const bool is_seed_kept = std::exchange(sample_seed_, int(seed)) == int(seed);
  return !is_index_kept || !is_seed_kept;
}

bool ShadowPass::has_blended() const
{
  return std::ranges::any_of(kinds_, &Kind::is_blended);
}

void ShadowPass::update(render_scene::RenderScene &scene, ShaderCache &shaders, const Settings &settings,
                        std::uint64_t settings_revision, Feature features, std::span<const draw::ObjectIndex> objects)
{
  if (has_casters_) {
    return;
  }
  const Key key{scene.objects().structure_revision(), scene.passes_revision(), settings_revision, shaders.revision(),
                has(features, any_shadow)};
  const bool is_winding_kept = std::ranges::none_of(objects, [&](draw::ObjectIndex index) {
    return index < is_mirrored_.size() && is_mirrored_[index] != scene.objects().is_mirrored(index);
  });
  if (recorded_ != key || !is_winding_kept || !pass_.is_current(scene.device())) {
    record(scene, shaders, settings, key, objects);
  }
  add_casters(scene, objects);
}

void ShadowPass::record(render_scene::RenderScene &scene, ShaderCache &shaders, const Settings &settings,
                        const Key &key, std::span<const draw::ObjectIndex> objects)
{
  recorded_.reset();
  pass_.clear();
  groups_.clear();
  kinds_.clear();
  kind_of_.assign(scene.objects().index_end(), 0);
  is_mirrored_.assign(scene.objects().index_end(), false);
  // By mesh and winding: the number of the kind, from 1. 0: there is none yet.
  std::vector<std::array<std::uint32_t, 2>> numbers(scene.scene().meshes().index_end());
  for (const draw::ObjectIndex index : objects) {
    const render_scene::RenderObject &object = scene.object(index);
    const bool is_mirrored = scene.objects().is_mirrored(index);
    is_mirrored_[index] = is_mirrored;
    if (!key.has_shadows || !object.casts_shadow) {
      continue;
    }
    std::uint32_t &number = numbers[object.mesh.index][is_mirrored ? 1 : 0];
    if (number == 0) {
      kinds_.push_back(record_kind(scene, shaders, settings, index));
      number = std::uint32_t(kinds_.size());
    }
    kind_of_[index] = number;
  }
  recorded_ = key;
}

ShadowPass::Kind ShadowPass::record_kind(render_scene::RenderScene &render_scene, ShaderCache &shaders,
                                         const Settings &settings, draw::ObjectIndex first)
{
  const scene::Handle<scene::Mesh> handle = render_scene.object(first).mesh;
  const scene::Scene &scene = render_scene.scene();
  const scene::Mesh &mesh = scene.meshes()[handle];
  if (mesh.topology != scene::Topology::Triangles) {
    return {.handle = handle};
  }
  const scene::Material &material = scene.material_of(mesh);
  const bool is_open = render_scene::has_open_shadow(scene, mesh);
  const MaterialClass cut_out = is_open ? MaterialClass::Full : render_scene::mask_class(scene, mesh);
  const State winding = is_mirrored_[first] ? State::FrontClockwise : State::None;
  const FunctionText function = cut_out == MaterialClass::Plain ? FunctionText() : alpha_function_of(scene, material);
  const gpu::Shader &shader =
      shaders.get(render_scene.device(), shadow_shader(shadows_.layer_pass()),
                  mask_features(cut_out) | (is_open ? Feature::OpacityThreshold : Feature::None), function);
  const State faces = material.is_double_sided ? State::None : culled_state(settings.shadow.caster_faces);
  // Without culling the winding has no effect.
  const State state = faces == State::None ? State::None : faces | winding;
  const TextureSet textures =
      cut_out == MaterialClass::Plain
          ? TextureSet()
          : textures_of(scene, mesh, function.key != 0 ? MaterialClass::Full : MaterialClass::BaseColor);
  draw::ShadingGroup *&group = groups_[{&pass_, shader.id(), state, textures}];
  if (!group) {
    group = &pass_.group(shader);
    group->state_enable(state);
    materials_.bind_casters(*group, function.key != 0);
    group->bind_uniform_ref("shadow_render_block", shadows_.render_block());
    group->constant_ref("sample_index", &sample_index_);
    group->constant_ref("sample_seed", &sample_seed_);
    render_scene::bind_textures(*group, render_scene, cut_out, textures);
  }
  return {.handle = handle, .instances = &group->instances(render_scene.batch(handle, streams_of(cut_out)))};
}

void ShadowPass::add_casters(render_scene::RenderScene &scene, std::span<const draw::ObjectIndex> objects)
{
  std::vector<std::pair<const scene::Mesh *, std::uint64_t>> meshes;
  meshes.reserve(kinds_.size());
  for (Kind &kind : kinds_) {
    const scene::Mesh &mesh = scene.scene().meshes()[kind.handle];
    meshes.emplace_back(mesh.host_shape ? nullptr : &mesh, mesh_fingerprint(scene, kind.handle));
    kind.is_blended = render_scene::has_open_shadow(scene.scene(), mesh);
  }
  for (const draw::ObjectIndex index : objects) {
    const std::uint32_t number = kind_of_[index];
    if (number == 0 || kinds_[number - 1].instances == nullptr) {
      continue;
    }
    const Kind &kind = kinds_[number - 1];
    const auto &[mesh, mesh_print] = meshes[number - 1];
    const glm::mat4 &world_from_object = scene.objects().world_from_object(index);
    const std::uint64_t fingerprint = caster_fingerprint({world_from_object, mesh_print});
    shadows_.add_caster(
        {scene.object(index).bounds, index, kind.instances, fingerprint, mesh, &world_from_object, kind.is_blended});
  }
  shadows_.finish();
  has_casters_ = true;
}

FrameStep shadows_step(Shadows &shadows, ShadowPass &pass, const DepthFeedback &feedback)
{
  return {.name = "shadows",
          .summary = "Draws and filters the layers of lamps that are not up to date.",
          .part = FrameStep::Part::Each,
          .need =
              [](const FrameState &state) {
                return !has(state.features, any_shadow) ? Need{false, why_no_shadow(state, "no lamp casts a shadow")}
                       : state.is_seen                  ? Need{true, "some layers were out of date"}
                                                        : Need{false, nothing_seen};
              },
          // The host fits cascades to them after they are read back.
          .reads = {{"depth", {}, [](const FrameState &) { return false; }}},
          .writes = {"shadow_render_block", "shadow_cubes", "shadow_maps", "shadow_distance_cube", "shadow_esm",
                     "shadow_esm_half", "shadow_evsm", "esm_distance", "esm_rows"},
          .record =
              [&](FrameSample &sample, gpu::CommandList &list) {
                draw::Viewport &viewport = sample.viewport;
                const draw::SamplePart part = viewport.part();
                const bool is_disturbed = pass.set_sample(sample.index, sample.settings.seed);
                if (is_disturbed || (sample.settings.planned_sample_count() > 1 && part.is_first)) {
                  shadows.invalidate_blended();
                }
                // Two viewports that draw parts in turn would never have all layers, which are one sample's, so that
                // one draws all.
                const int parts_max = part.is_first || !is_disturbed ? part.setup_max : draw::Viewport::no_setup_max;
                const UpdatedLayers updated = shadows.update(
                    viewport.device(), view_around_lens(sample.view), pixel_size(sample.view, viewport), pass.pass(),
                    list, sample.lamp_points, feedback.picture(viewport.drawn_size_px()), parts_max);
                viewport.set_setup(updated.part_count, updated.left_count);
              },
          .submitted = [&](FrameSample &) { shadows.submitted(); }};
}

}  // namespace gnomon::eevee
