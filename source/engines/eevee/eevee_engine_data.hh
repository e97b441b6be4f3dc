// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_adaptive.hh"
#include "eevee_debug.hh"
#include "eevee_emission.hh"
#include "eevee_frame.hh"
#include "eevee_lamp_points.hh"
#include "eevee_lamps.hh"
#include "eevee_lights.hh"
#include "eevee_world.hh"
#include "shadows/shadows.hh"

#include "draw_target_pass.hh"
#include "draw_viewport.hh"
#include "render_surfaces.hh"

#include <array>
#include <map>
#include <memory>
#include <tuple>

/** The engine's data in a viewport. Internal to the engine. */
namespace gnomon::eevee {

inline gpu::Texture create_target(gpu::Device &device, const char *name, gpu::Format format, glm::ivec2 size_px)
{
  return device.create_texture({.name = name, .format = format, .width = size_px.x, .height = size_px.y});
}

struct FramebufferList {
  gpu::Framebuffer depth_fb;
  gpu::Framebuffer main_fb;
  gpu::Framebuffer film_fb;
  gpu::Framebuffer picture_depth_fb;
  gpu::Framebuffer probe_fb;
  gpu::Framebuffer surfaces_fb;
};

struct TextureList {
  /** With deferred lighting, it holds the G-buffer before. */
  gpu::Texture radiance;
  /**
   * Copy of `radiance` before transmissive surfaces are drawn. Created when the first one is seen; \see make_behind.
   */
  gpu::Texture behind;
  gpu::Sampler behind_sampler;
  /** Weighted sum of the samples. */
  gpu::Texture film;
  /** Depth of the view without sample offsets. Created if a target has depth and a picture has several samples. */
  gpu::Texture picture_depth;
  gpu::Texture probe_position;
  gpu::Texture probe_normal;
  gpu::Texture surface_position;
  gpu::Texture surface_normal;
  gpu::Texture surface_albedo;
  gpu::Sampler nearest;
};

struct PassList {
  explicit PassList(draw::ObjectBuffer &objects)
      : depth_pass("depth_pass", gpu::State::WriteDepth | gpu::State::DepthNearerEqual, &objects),
        depth_pass_cull("depth_pass_cull", gpu::State::WriteDepth | gpu::State::DepthNearerEqual | gpu::State::CullBack,
                        &objects),
        gbuffer_pass("gbuffer_pass", gpu::State::WriteColor | gpu::State::WriteDepth | gpu::State::DepthNearerEqual,
                     &objects),
        deferred_lit_pass("deferred_lit_pass", gpu::State::WriteColor | gpu::State::DepthFurther),
        background_pass("background_pass", gpu::State::WriteColor | gpu::State::DepthEqual),
        lit_pass("lit_pass", gpu::State::WriteColor | gpu::State::DepthEqual, &objects),
        blend_pass("blend_pass", gpu::State::WriteColor | gpu::State::DepthNearerEqual | gpu::State::BlendOver,
                   &objects),
        transmission_depth_pass("transmission_depth_pass", gpu::State::WriteDepth | gpu::State::DepthNearerEqual,
                                &objects),
        transmission_pass("transmission_pass", gpu::State::WriteColor | gpu::State::DepthEqual, &objects),
        probe_pass("probe_pass", gpu::State::WriteColor | gpu::State::DepthEqual, &objects),
        surfaces_pass("surfaces_pass", gpu::State::WriteColor | gpu::State::DepthEqual, &objects),
        tint_pass("tint_pass", gpu::State::WriteColor | gpu::State::DepthEqual | gpu::State::BlendMultiply, &objects),
        film_pass("film_pass", gpu::State::WriteColor | gpu::State::BlendAdd),
        adaptive_test_pass("adaptive_test_pass", gpu::State::WriteDepth),
        adaptive_spread_pass("adaptive_spread_pass", gpu::State::WriteDepth),
        adaptive_depth_pass("adaptive_depth_pass", gpu::State::WriteDepth | gpu::State::DepthNearerEqual),
        adaptive_background_pass("adaptive_background_pass", gpu::State::WriteDepth | gpu::State::DepthFurther),
        film_sampled_pass("film_sampled_pass",
                          gpu::State::WriteColor | gpu::State::BlendAdd | gpu::State::DepthNearerEqual),
        film_converged_pass("film_converged_pass",
                            gpu::State::WriteColor | gpu::State::BlendMultiply | gpu::State::DepthFurther),
        tonemap("tonemap", gpu::State::WriteColor)
  {
  }
  draw::Pass depth_pass;
  draw::Pass depth_pass_cull;
  /** The objects of deferred lighting, in one pass with their depths. */
  draw::Pass gbuffer_pass;
  /** Empty if gbuffer_pass is. */
  draw::Pass deferred_lit_pass;
  draw::Pass background_pass;
  draw::Pass lit_pass;
  /** A group or two for each blended object. */
  draw::Pass blend_pass;
  draw::Pass transmission_depth_pass;
  draw::Pass transmission_pass;
  draw::Pass probe_pass;
  draw::Pass surfaces_pass;
  draw::Pass tint_pass;
  draw::Pass film_pass;
  /** Empty without a threshold, as those after it. \see eevee_adaptive.hh */
  draw::Pass adaptive_test_pass;
  draw::Pass adaptive_spread_pass;
  draw::Pass adaptive_depth_pass;
  draw::Pass adaptive_background_pass;
  /** Instead of film_pass. */
  draw::Pass film_sampled_pass;
  draw::Pass film_converged_pass;
  draw::Pass tonemap;
};

/** The calls of one group share the pass, the shader, the additional state and the material's textures. */
using GroupKey = std::tuple<const draw::Pass *, gpu::ResourceId, gpu::State, render_scene::TextureSet>;

/** Revisions of everything that recorded passes depend on. */
struct PassesKey {
  std::uint64_t structure = 0;
  std::uint64_t passes = 0;
  std::uint64_t settings = 0;
  std::uint64_t shaders = 0;
  /** Revision of the exponential shadows, whose textures and blocks are bound by value. 0 if there are none. */
  std::uint64_t exponential_lamps = 0;
  gpu::ResourceId shadow_block = 0;
  gpu::ResourceId light_block = 0;
  gpu::ResourceId light_shape_block = 0;
  gpu::ResourceId light_texture = 0;
  gpu::ResourceId light_cluster_block = 0;
  gpu::ResourceId ltc_table = 0;
  gpu::ResourceId multiscatter_table = 0;
  gpu::ResourceId world_block = 0;
  gpu::ResourceId world_levels = 0;
  gpu::ResourceId world_picture = 0;
  gpu::ResourceId behind = 0;
  gpu::ResourceId surface_function_block = 0;
  gpu::ResourceId film_converged = 0;
  /** Scene::world_revision if there is a background, otherwise 0. */
  std::uint64_t world = 0;
  Feature features = Feature::None;
  std::optional<int> tinted_light;

  bool operator==(const PassesKey &) const = default;
};

/** Revisions of everything that the lamps' shadows depend on. */
struct ShadowsKey {
  std::uint64_t lamps = 0;
  std::uint64_t objects = 0;
  std::uint64_t passes = 0;
  std::uint64_t settings = 0;
  std::uint64_t shaders = 0;
  std::uint64_t viewports = 0;
  std::uint64_t emission = 0;
  std::uint64_t host_content = 0;

  bool operator==(const ShadowsKey &) const = default;
};

/** Revisions of everything that the picture depends on, except the view and the size. */
struct PictureKey {
  std::uint64_t objects = 0;
  std::uint64_t lamps = 0;
  std::uint64_t passes = 0;
  std::uint64_t materials = 0;
  std::uint64_t settings = 0;
  std::uint64_t shaders = 0;
  std::uint64_t host_content = 0;

  bool operator==(const PictureKey &) const = default;
};

/** Revisions of everything that the recorded casters depend on. */
struct CastersKey {
  std::uint64_t structure = 0;
  std::uint64_t passes = 0;
  std::uint64_t settings = 0;
  std::uint64_t shaders = 0;
  bool has_shadows = false;

  bool operator==(const CastersKey &) const = default;
};

/** Key of the recording of an object, beside its index. All objects of a mesh are of one kind, or of few. */
struct ObjectKind {
  gpu::BatchRange batch{};
  /** The groups that have calls of the objects: no more than one in each of five passes. */
  std::array<draw::ShadingGroup *, 5> groups{};
  std::size_t group_count = 0;
  /** The program of PassList::blend_pass, where each object has groups of its own; nullptr: they are not in it. */
  const gpu::Shader *blend_shader = nullptr;
};

/** Key of the shadow of a caster, beside its matrix: all casters of a mesh and winding are of one kind. */
struct CasterKind {
  scene::Handle<scene::Mesh> handle;
  /** The call in SharedData::shadow_pass; nullptr: the mesh casts no shadow, because it has no triangles. */
  draw::InstanceCall *instances = nullptr;
  /** \see Caster. It changes without a new recording. */
  bool is_blended = false;
};

/** Data that all viewports of a scene share. It is destroyed with the last viewport. */
struct SharedData {
  explicit SharedData(draw::ObjectBuffer &objects)
      : shadow_pass("shadow_pass", gpu::State::WriteDepth | gpu::State::DepthNearerEqual | gpu::State::DepthClamp,
                    &objects)
  {
  }
  SceneEmission emission;
  /** The lamps of the scene, followed by the lamps of emission_lamps and of world_lamps. */
  std::vector<scene::PlacedLamp> placed;
  Lamps lamps;
  /** By index in Lamps::lights: whether the light is not in Settings::light. */
  std::vector<bool> is_light_left_out;
  /** Empty unless Settings::light has no emission. */
  std::optional<render_scene::MaterialTable> materials_without_emission;
  /** Points of lamps with an extent. Empty if a picture has one sample: then these lamps are shaded as a whole. */
  LampPoints lamp_points;
  SceneShadows shadows;
  std::optional<ShadowsKey> synced;
  /** Increased by each sync of the lamps. */
  std::uint64_t revision = 0;
  /** The scene's bounds at the last sync of the lamps. */
  scene::Bounds bounds_ws;
  /** Increased when the reach of a light, or the order of the lights, changes. */
  std::uint64_t reaches_revision = 0;
  /** Index in Lamps::lights of the sun of Settings::has_cascade_tint. Empty without this setting or such a sun. */
  std::optional<int> tinted_light;
  /**
   * The lights. With Feature::LightClusters, they are in `light_texture`; then this block exists for Inspection::probe
   * and the tint of cascades, and has only the lights of these: probed_entry and tinted_entry.
   */
  gpu::Buffer light_block;
  gpu::Buffer light_shape_block;
  /** Empty without Feature::LightClusters. */
  gpu::Texture light_texture;
  gpu::Sampler light_sampler;
  /** Content of `light_texture`: LIGHT_TEXELS for each light. */
  std::vector<glm::vec4> light_texels;
  /** Empty unless the scene has specular materials, and lamps with Feature::LampShape or a world. */
  gpu::Texture ltc_table;
  /** Empty without Feature::Multiscatter. */
  gpu::Texture multiscatter_table;
  /** The sampler of both tables. */
  gpu::Sampler table_sampler;
  /** Empty without a world. */
  WorldResources world;
  /** The lights on the device are those of the last sync. */
  bool are_lights_written = false;
  /** Empty unless a material has a surface function. */
  gpu::Buffer surface_function_block;
  /** Draws the casters; all lamps share it. */
  draw::Pass shadow_pass;
  gpu::BufferRange object_block;
  gpu::BufferRange material_block;
  gpu::BufferRange full_material_block;
  /** The groups of shadow_pass. */
  std::map<GroupKey, draw::ShadingGroup *> groups;
  std::vector<CasterKind> caster_kinds;
  /** By object index: the number of its kind in `caster_kinds`, from 1; 0 for objects that cast no shadow. */
  std::vector<std::uint32_t> caster_kind_of;
  /** Sample for which blended casters are drawn; shadow_pass reads both by reference. */
  int sample_index = 0;
  int sample_seed = 0;
  /** By object index: whether the caster was recorded with a mirrored matrix. */
  std::vector<bool> is_mirrored;
  std::optional<CastersKey> recorded;
  /** Whether `shadows` has the casters of the last sync. */
  bool has_casters = false;
  /** gpu::Device::loss_count up to which lost submissions were handled. */
  std::uint64_t loss_count = 0;
};

/** The groups of an object in PassList::blend_pass. */
struct BlendedObject {
  draw::ObjectIndex object = draw::object_identity;
  std::uint32_t first_group = 0;
  std::uint32_t group_count = 0;
  /** It reads TextureList::behind. */
  bool is_transmissive = false;
};

/** A drawable object whose material transmits light. */
struct TransmissiveObject {
  draw::ObjectIndex object = draw::object_identity;
  /** True: the object is in PassList::blend_pass. False: in transmission_pass. */
  bool is_blended = false;
};

/** Key of the order of blended objects. */
struct BlendOrderKey {
  /** \see render_scene::eye_of */
  glm::vec4 eye_ws{0.0F};
  std::uint64_t objects = 0;
  std::uint64_t recording = 0;
  /** Indices in StorageList::blended. */
  std::vector<std::uint32_t> visible{};
  /** The visible objects of transmission_pass. */
  std::vector<draw::ObjectIndex> transmissive{};

  bool operator==(const BlendOrderKey &) const = default;
};

struct StorageList {
  /** Created by the first sync. */
  std::optional<Shadows> shadows;
  Feature features = Feature::None;
  /** Drawable objects in the order of their first cache_populate. Recorded when at least one of them is visible. */
  std::vector<draw::ObjectIndex> objects;
  /** True between cache_init and cache_finish. */
  bool is_collecting = false;
  /** Memory of FrameSample::lamp_points between two samples. Its content has no meaning. */
  SampledLampPoints lamp_points_memory;
  /** Temporary memory of write_lamp_points. */
  std::vector<shared::LightData> sampled_lights;
  /** Empty without Feature::LightClusters. */
  ViewClusters clusters;
  gpu::Buffer view_block;
  gpu::BufferRange material_block;
  gpu::BufferRange full_material_block;
  gpu::BufferRange layer_block;
  /** The groups of the passes that draw objects. */
  std::map<GroupKey, draw::ShadingGroup *> groups;
  /** The objects of PassList::blend_pass. */
  std::vector<BlendedObject> blended;
  std::uint32_t blended_group_count = 0;
  std::optional<BlendOrderKey> blend_ordered;
  /** Groups of PassList::blend_pass behind all that transmits light, from back to front, and the rest of the groups. */
  std::vector<std::uint32_t> groups_behind;
  std::vector<std::uint32_t> groups_in_front;
  std::vector<TransmissiveObject> transmissive;
  /** At least one object of `transmissive` is not smooth, so that TextureList::behind has mip levels. */
  bool is_transmission_rough = false;
  /** By object index: whether the passes were recorded with a mirrored matrix. */
  std::vector<bool> is_mirrored;
  /** The matrix of an object became mirrored or ceased to be mirrored since the passes were recorded. */
  bool is_winding_changed = false;
  std::optional<PassesKey> recorded;
  /** \see Report::pass_recordings */
  std::uint64_t pass_recordings = 0;
  /** SharedData::revision from which `features` was derived. */
  std::uint64_t shared_revision = 0;
  /** Sum of the revisions from which `material_features` was derived. */
  std::uint64_t materials_features_revision = ~std::uint64_t(0);
  /** The class with the most inputs, and the features, that the materials of the drawable objects need. */
  render_scene::MaterialClass widest_class = render_scene::MaterialClass::Plain;
  Feature material_features = Feature::None;
  /** Least alpha of a specular lobe of these materials; 1 without one. */
  float alpha_min = 1.0F;
  /** The material of at least one drawable object has a surface function. */
  bool has_surface_functions = false;
  /** The mode of the recorded passes. \see Engine::is_scene_deferred */
  bool is_deferred = false;
  /** Entry of light_block of the light that is being probed. */
  int probed_light = 0;
  /** Filter weights of the current sample. The film pass reads them by reference. */
  glm::vec4 film_columns{0.0F};
  glm::vec4 film_rows{0.0F};
  /** View rays of the current sample. The background pass reads them by reference. \see eevee_background_frag.glsl */
  glm::vec4 background_corner{0.0F};
  glm::vec4 background_across{0.0F};
  glm::vec4 background_up{0.0F};
  /** \see sample_step */
  int sample_step = 1;
  double film_weight_sum = 0.0;
  /** Sum of the filter weights of the samples drawn so far, in units of `film_weight_sum`. */
  double film_share = 0.0;
  std::optional<PictureKey> synced_picture;
  draw::TargetPass target_pass;
};

struct Timing {
  struct Step {
    std::string name;
    gpu::TimerQuery query;
    /** The step was drawn since the last call of Inspection::take_step_times. */
    bool is_pending = false;
    /** The last result of Inspection::take_step_times; empty if the backend measures no times (null backend). */
    std::optional<double> taken_seconds{};
  };
  std::vector<Step> steps;
};

/** Depths of the pre-pass that are read back, to fit the cascades of suns to them. */
struct DepthFeedback {
  /** The views of the last requests, indexed by the tag modulo the size of the array. */
  std::array<draw::View, 4> requested_views{};
  std::uint64_t requested_tag = 0;
  std::uint64_t received_tag = 0;
  /** Requests with lower tags belong to an earlier state of the scene and are ignored. */
  std::uint64_t first_valid_tag = 1;
  /** The view of `depths`. Empty if there are no depths. */
  std::optional<draw::View> view;
  std::vector<float> depths;

  /** Whether the last request has no result yet. */
  [[nodiscard]] bool is_pending() const
  {
    return requested_tag >= first_valid_tag && received_tag < requested_tag;
  }
  /** \a size_px: of the depth texture. */
  [[nodiscard]] PictureDepths picture(glm::ivec2 size_px) const
  {
    return {depths, size_px, view.value_or(draw::View())};
  }
  /** Discard the depths and all pending requests, because the scene or the size changed. */
  void forget()
  {
    first_valid_tag = requested_tag + 1;
    view.reset();
    depths.clear();
  }
};

struct Data final : draw::EngineViewportData {
  void resized() override
  {
    depth_feedback.forget();
    fbl = {};
    txl = {};
    adaptive = {};
    is_synced = false;
    stl.recorded.reset();
    stl.target_pass.reset();
  }
  /** Created by the first sync. It must outlive StorageList::shadows. */
  std::shared_ptr<SharedData> shared;
  FramebufferList fbl;
  TextureList txl;
  std::unique_ptr<PassList> psl;
  StorageList stl;
  AdaptiveSampling adaptive;
  /** The visible objects of the view that was recorded last. */
  draw::VisibleObjects visible;
  Timing timing;
  DepthFeedback depth_feedback;
  /** The target of the current draw, or of the last draw. */
  draw::Target target;
  int sample_index = 0;
  /** Whole samples in TextureList::film. */
  int film_sample_count = 0;
  /** gpu::Device::loss_count up to which lost submissions of this viewport were handled. */
  std::uint64_t loss_count = 0;
  ShadowPicture shadow_picture;
  /** The last sync and the recording after it did not fail. Otherwise drawing throws. */
  bool is_synced = false;
  /** Passes, programs and targets are up to date: an object or a background was visible since the last sync. */
  bool is_recorded = false;
  /** An object or a background was visible in at least one sample of the current picture. */
  bool is_seen = false;
  /** An object of StorageList::transmissive is in the view of the current sample. */
  bool is_transmission_seen = false;
  /** Engine::finish ended the current picture. */
  bool is_finished = false;
  /** TextureList::picture_depth holds the depth of the current picture. */
  bool has_picture_depth = false;
  /** One entry for each of frame_steps(), for the current picture. Empty before the first sample. */
  std::vector<StepRecord> frame;
};

/** Create TextureList::behind, with as many mip levels as the materials need. */
void make_behind(Data &data, const draw::Viewport &viewport);

/** Bind the resources that a program with lighting reads, except the textures of the material. */
void bind_lit(draw::ShadingGroup &group, Data &data);

}  // namespace gnomon::eevee
