// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_debug.hh"
#include "eevee_frame.hh"
#include "eevee_lamp_points.hh"
#include "eevee_lamps.hh"
#include "eevee_world.hh"
#include "shadows/shadows.hh"

#include "draw_viewport.hh"
#include "render_surfaces.hh"

#include <array>
#include <map>
#include <memory>
#include <tuple>

/** What the engine keeps in a viewport. For the engine's own files. */
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
};

struct TextureList {
  gpu::Texture radiance;
  /** Sum of the weighted samples. */
  gpu::Texture film;
  /** Without the samples' offsets. Made where a target takes the depth of several samples. */
  gpu::Texture picture_depth;
  gpu::Texture probe_position;
  gpu::Texture probe_normal;
  gpu::Sampler nearest;
};

struct PassList {
  explicit PassList(draw::ObjectBuffer &objects)
      : depth_pass("depth_pass", gpu::State::WriteDepth | gpu::State::DepthNearerEqual, &objects),
        depth_pass_cull("depth_pass_cull", gpu::State::WriteDepth | gpu::State::DepthNearerEqual | gpu::State::CullBack,
                        &objects),
        background_pass("background_pass", gpu::State::WriteColor | gpu::State::DepthEqual),
        lit_pass("lit_pass", gpu::State::WriteColor | gpu::State::DepthEqual, &objects),
        probe_pass("probe_pass", gpu::State::WriteColor | gpu::State::DepthEqual, &objects),
        tint_pass("tint_pass", gpu::State::WriteColor | gpu::State::DepthEqual | gpu::State::BlendMultiply, &objects),
        film_pass("film_pass", gpu::State::WriteColor | gpu::State::BlendAdd),
        tonemap("tonemap", gpu::State::WriteColor)
  {
  }
  draw::Pass depth_pass;
  draw::Pass depth_pass_cull;
  draw::Pass background_pass;
  draw::Pass lit_pass;
  draw::Pass probe_pass;
  draw::Pass tint_pass;
  draw::Pass film_pass;
  draw::Pass tonemap;
};

/** What calls of one group have in common: pass, shader, state beside the pass's, textures of the material. */
using GroupKey = std::tuple<const draw::Pass *, gpu::ResourceId, gpu::State, render_scene::TextureSet>;

/** Revisions of everything that recorded passes depend on. */
struct PassesKey {
  std::uint64_t structure = 0;
  std::uint64_t passes = 0;
  std::uint64_t settings = 0;
  std::uint64_t shaders = 0;
  /** Of shadows whose textures and blocks are bound by value. */
  std::uint64_t exponential_lamps = 0;
  gpu::ResourceId shadow_block = 0;
  gpu::ResourceId light_block = 0;
  gpu::ResourceId light_shape_block = 0;
  gpu::ResourceId ltc_table = 0;
  gpu::ResourceId world_block = 0;
  gpu::ResourceId world_levels = 0;
  gpu::ResourceId world_picture = 0;
  /** Of what the background shows of it. */
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

  bool operator==(const ShadowsKey &) const = default;
};

/** Revisions of everything that the picture depends on, beside its view and size. */
struct PictureKey {
  std::uint64_t objects = 0;
  std::uint64_t lamps = 0;
  std::uint64_t passes = 0;
  std::uint64_t materials = 0;
  std::uint64_t settings = 0;
  std::uint64_t shaders = 0;

  bool operator==(const PictureKey &) const = default;
};

/** What the tonemap pass was recorded for. */
struct TonemapKey {
  gpu::State state = gpu::State::None;
  /** 0: the target takes no depth. */
  gpu::ResourceId depth_texture = 0;

  bool operator==(const TonemapKey &) const = default;
};

/** The tonemap pass reads these by reference. \see eevee_tonemap_frag.glsl */
struct TonemapConstants {
  draw::DepthMap depth;
  glm::ivec2 origin_px{0};
  int view_transform = 0;
  int encoding = 0;
  float exposure_scale = 1.0F;
  float sample_scale = 1.0F;
  int is_over = 0;
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

/** What the engine keeps for all viewports of its scene. It goes with the last of them. */
struct SharedData {
  explicit SharedData(draw::ObjectBuffer &objects)
      : shadow_pass("shadow_pass", gpu::State::WriteDepth | gpu::State::DepthNearerEqual | gpu::State::DepthClamp,
                    &objects)
  {
  }
  /** The scene's, and those that stand for its world. */
  std::vector<scene::PlacedLamp> placed;
  Lamps lamps;
  /** Of lamps with an extent; empty where a picture has one sample, which is lit from their centres. */
  LampPoints lamp_points;
  SceneShadows shadows;
  std::optional<ShadowsKey> synced;
  /** Increased by each sync of the lamps. */
  std::uint64_t revision = 0;
  /** In light_block: the sun whose cascades are shown; nothing where there is none, or where it was not asked for. */
  std::optional<int> tinted_light;
  gpu::Buffer light_block;
  gpu::Buffer light_shape_block;
  /** Where a specular surface is lit by a lamp that is shaded as a whole. */
  gpu::Texture ltc_table;
  gpu::Sampler ltc_sampler;
  /** Where a world shines. */
  WorldResources world;
  bool is_light_block_written = false;
  /** Draws the casters of any lamp. */
  draw::Pass shadow_pass;
  gpu::BufferRange object_block;
  gpu::BufferRange material_block;
  gpu::BufferRange full_material_block;
  /** Of shadow_pass; made when the first object needs them. */
  std::map<GroupKey, draw::ShadingGroup *> groups;
  /** For each mesh and winding of casters, the call in shadow_pass. */
  std::map<std::pair<scene::Handle<scene::Mesh>, gpu::State>, draw::InstanceCall *> caster_calls;
  /** By object index: the call of a caster; nullptr for objects that cast no shadow. */
  std::vector<draw::InstanceCall *> caster_of;
  /** By object index: the caster was recorded for a mirrored matrix. */
  std::vector<bool> is_mirrored;
  std::optional<CastersKey> recorded;
  /** The shadows have the casters of the last sync. */
  bool has_casters = false;
  /** gpu::Device::loss_count when the device was known to hold what is noted here. */
  std::uint64_t loss_count = 0;
};

struct StorageList {
  /** Made by the first sync. */
  std::optional<Shadows> shadows;
  Feature features = Feature::None;
  /** Drawable objects, in the order of their first cache_populate; recorded when a view touches any of them. */
  std::vector<draw::ObjectIndex> objects;
  /** cache_init was called, and cache_finish not yet. */
  bool is_collecting = false;
  /** Of the sample being drawn. */
  std::span<const LampPoint> lamp_points;
  /** Memory for write_lamp_points. */
  std::vector<shared::LightData> sampled_lights;
  gpu::Buffer view_block;
  gpu::BufferRange material_block;
  gpu::BufferRange full_material_block;
  gpu::BufferRange object_block;
  /** Made when the first object needs them. */
  std::map<GroupKey, draw::ShadingGroup *> groups;
  /** By object index: passes were recorded for a mirrored matrix. */
  std::vector<bool> is_mirrored;
  /** An object changed in a way that passes depend on. */
  bool is_winding_changed = false;
  std::optional<PassesKey> recorded;
  /** \see Report */
  std::uint64_t pass_recordings = 0;
  /** SharedData::revision that features and passes follow. */
  std::uint64_t shared_revision = 0;
  /** Of the material table. */
  std::uint64_t materials_features_revision = ~std::uint64_t(0);
  /** Specular and FullMaterial, as the materials need them. */
  Feature material_features = Feature::None;
  /** In light_block, of the probe being drawn. */
  int probed_light = 0;
  /** Of the sample being drawn; the film pass reads it by reference. */
  glm::vec4 film_columns{0.0F};
  glm::vec4 film_rows{0.0F};
  /** The same for the background; \see eevee_background_frag.glsl */
  glm::vec4 background_corner{0.0F};
  glm::vec4 background_across{0.0F};
  glm::vec4 background_up{0.0F};
  double film_weight_sum = 0.0;
  /** Part of the whole picture's weight that the samples drawn so far have. */
  double film_share = 0.0;
  std::optional<PictureKey> synced_picture;
  std::optional<TonemapKey> tonemap_recorded;
  TonemapConstants tonemap;
};

struct Timing {
  struct Step {
    std::string name;
    gpu::TimerQuery query;
    /** Drawn since the last Engine::take_step_times. */
    bool is_pending = false;
    /** Nothing where no time passes (null backend). */
    std::optional<double> seconds{};
    /** What Engine::take_step_times gave last. */
    std::optional<double> taken_seconds{};
  };
  std::vector<Step> steps;
};

/** Depths that the device reports, for suns that are fitted to them. */
struct DepthFeedback {
  /** The view of each of the last requests, by its tag modulo their number. */
  std::array<glm::mat4, 4> requested_clip_from_world{};
  std::uint64_t requested_tag = 0;
  std::uint64_t received_tag = 0;
  /** Depths of earlier requests are of an earlier state of the scene. */
  std::uint64_t first_valid_tag = 1;
  /** The view that `depths` shows; nothing: there are none. */
  std::optional<glm::mat4> clip_from_world;
  std::vector<float> depths;

  /** The last request is not answered. */
  [[nodiscard]] bool is_pending() const
  {
    return requested_tag >= first_valid_tag && received_tag < requested_tag;
  }
  /** The scene changed. */
  void forget()
  {
    first_valid_tag = requested_tag + 1;
    clip_from_world.reset();
    depths.clear();
  }
};

struct Data final : draw::EngineViewportData {
  void resized() override
  {
    depth_feedback.forget();
    fbl = {};
    txl = {};
    is_synced = false;
    stl.recorded.reset();
    stl.tonemap_recorded.reset();
  }
  /** Made by the first sync; it must outlive the shadows of the viewport. */
  std::shared_ptr<SharedData> shared;
  FramebufferList fbl;
  TextureList txl;
  std::unique_ptr<PassList> psl;
  StorageList stl;
  Timing timing;
  DepthFeedback depth_feedback;
  /** Of the draw at hand, or of the last one. */
  draw::Target target;
  int sample_index = 0;
  /** As SharedData::loss_count. */
  std::uint64_t loss_count = 0;
  ShadowPicture shadow_picture;
  /** The last sync came to its end, and so did what was recorded since. */
  bool is_synced = false;
  /** A view touched an object since the last sync: passes, programs and targets are up to date. */
  bool is_recorded = false;
  /** A sample of the picture at hand did. */
  bool is_seen = false;
  /** TextureList::picture_depth is of the picture at hand. */
  bool has_picture_depth = false;
  /** One for each of frame_steps(), of the picture at hand; empty before the first sample. */
  std::vector<StepRecord> frame;
};

}  // namespace gnomon::eevee
