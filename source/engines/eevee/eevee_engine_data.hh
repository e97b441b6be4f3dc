// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_debug.hh"
#include "eevee_lamps.hh"
#include "shadows/shadows.hh"
#include "eevee_textures.hh"

#include "draw_viewport.hh"

#include <array>
#include <map>
#include <tuple>

/** What the engine keeps in a viewport. For the engine's own files. */
namespace gnomon::eevee {

struct FramebufferList {
  gpu::Framebuffer depth_fb;
  gpu::Framebuffer main_fb;
  gpu::Framebuffer film_fb;
  gpu::Framebuffer display_fb;
  gpu::Framebuffer probe_fb;
};

struct TextureList {
  gpu::Texture radiance;
  /** Sum of the weighted samples. */
  gpu::Texture film;
  gpu::Texture display;
  gpu::Texture probe_position;
  gpu::Texture probe_normal;
  gpu::Sampler nearest;
};

struct PassList {
  explicit PassList(draw::ObjectBuffer &objects)
      : shadow_pass("shadow_pass", gpu::State::WriteDepth | gpu::State::DepthNearerEqual | gpu::State::DepthClamp,
                    &objects),
        depth_pass("depth_pass", gpu::State::WriteDepth | gpu::State::DepthNearerEqual, &objects),
        depth_pass_cull("depth_pass_cull", gpu::State::WriteDepth | gpu::State::DepthNearerEqual | gpu::State::CullBack,
                        &objects),
        pass("pass", gpu::State::WriteColor | gpu::State::DepthEqual, &objects),
        probe_pass("probe_pass", gpu::State::WriteColor | gpu::State::DepthEqual, &objects),
        tint_pass("tint_pass", gpu::State::WriteColor | gpu::State::DepthEqual | gpu::State::BlendMultiply, &objects),
        film_pass("film_pass", gpu::State::WriteColor | gpu::State::BlendAdd),
        tonemap("tonemap", gpu::State::WriteColor)
  {
  }
  draw::Pass shadow_pass;
  draw::Pass depth_pass;
  draw::Pass depth_pass_cull;
  draw::Pass pass;
  draw::Pass probe_pass;
  draw::Pass tint_pass;
  draw::Pass film_pass;
  draw::Pass tonemap;
};

/** What calls of one group have in common: pass, state beside the pass's, texture (-1: none). */
using GroupKey = std::tuple<const draw::Pass *, gpu::State, std::int32_t>;

struct MeshBatch {
  gpu::Batch batch;
  /** scene::Mesh::revision. */
  std::uint64_t revision = 0;
  bool has_uvs = false;
};

struct StorageList {
  Lamps lamps;
  Shadows shadows;
  Feature features = Feature::None;
  ShaderCache shaders;
  /** What may be seen; recorded when a view touches any of it. */
  std::vector<draw::ObjectRef> objects;
  /** One a mesh of the scene; empty until an object uses it. */
  std::vector<MeshBatch> batches;
  gpu::Buffer view_block;
  gpu::Buffer light_block;
  gpu::Buffer material_block;
  gpu::BufferRange object_block;
  Textures textures;
  /** Made when the first object needs them. */
  std::map<GroupKey, draw::ShadingGroup *> groups;
  /** One a mesh of the scene and winding; empty until a caster uses it. */
  std::vector<std::array<draw::InstanceCall *, 2>> caster_calls;
  /** In light_block, of the probe being drawn. */
  int probed_light = 0;
  /** In light_block: the sun whose cascades are shown; nothing where none is, or nobody asks. */
  std::optional<int> tinted_light;
  /** Of the sample being drawn; the film pass reads it by reference. */
  glm::vec4 film_columns{0.0F};
  glm::vec4 film_rows{0.0F};
  double film_weight_sum = 0.0;
};

struct Timing {
  struct Step {
    std::string name;
    gpu::TimerQuery query;
    bool is_pending = false;
    double seconds = 0.0;
    /** What Engine::take_step_times gave last; nothing where no time passes (null backend). */
    std::optional<double> taken_seconds{};
  };
  std::vector<Step> steps;
};

/** What became of a pass in the picture at hand, over its samples. */
struct PassRuns {
  std::uint64_t runs = 0;
  draw::RecordCounts counts;
};

struct Data final : draw::EngineViewportData {
  FramebufferList fbl;
  TextureList txl;
  std::unique_ptr<PassList> psl;
  StorageList stl;
  Timing timing;
  int samples_drawn = 0;
  ShadowPicture shadow_picture;
  /** The last sync came to its end, and so did what was recorded since. */
  bool is_synced = false;
  /** A view touched an object since the last sync: passes, programs and targets are made. */
  bool is_recorded = false;
  /** A sample of the picture at hand did. */
  bool is_seen = false;
  /** By the names of draw::Pass. */
  std::map<std::string, PassRuns> passes;
};

}  // namespace gnomon::eevee
