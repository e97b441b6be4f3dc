// SPDX-License-Identifier: MIT
#pragma once

#include "internal/eevee_blend.hh"
#include "internal/eevee_depth.hh"
#include "internal/eevee_probe.hh"
#include "internal/eevee_transmission.hh"

#include "render_surfaces.hh"

#include <map>
#include <tuple>

namespace gnomon::eevee {

/** The calls of one group share the pass, the shader, the additional state and the material's textures. */
using GroupKey = std::tuple<const draw::Pass *, gpu::ResourceId, gpu::State, render_scene::TextureSet>;

/**
 * All that the passes of surfaces depend on, beside their objects and the resources that they bind by value. No setting
 * reaches a recording but through these members, so that none can be left out of the comparison.
 */
struct SurfaceInputs {
  /** RenderScene::passes_revision: programs, states and textures follow from the meshes and materials. */
  std::uint64_t scene = 0;
  /** ShaderCache::revision: another engine may keep the programs from before a reload, so that they still exist. */
  std::uint64_t shaders = 0;
  /** A constant of programs. */
  PcfKernel pcf{};
  /** They select programs: those of the frame, and asked_features. */
  Feature features = Feature::None;
  /** Entry of `light_block` of the sun of Settings::has_cascade_tint. Empty: no cascade is tinted. */
  std::optional<int> tinted_entry{};
  /** Settings::has_probe and Settings::has_surfaces: each adds a pass. */
  bool has_probe = false;
  bool has_surfaces = false;
  /** Transmission::behind exists. Without it, nothing that transmits light is in the view, and its passes are empty. */
  bool has_behind = false;
  /** The view has clip planes. */
  bool is_clipped = false;

  bool operator==(const SurfaceInputs &) const = default;
};

/** Features of programs that settings ask for. */
[[nodiscard]] inline Feature asked_features(const Settings &settings)
{
  // Layers of front or back faces alone do not show all surfaces.
  return (settings.has_multiscatter ? Feature::Multiscatter : Feature::None) |
         (settings.shadow.caster_faces == CasterFaces::All ? Feature::SurfaceInLayers : Feature::None);
}

/**
 * The drawable objects of a viewport: sorts them into the passes of modules, and owns the passes that shade forward
 * objects. Internal to the engine.
 */
class SurfacePasses {
 public:
  SurfacePasses(draw::ObjectBuffer &objects, const RenderBuffers &buffers, DepthPasses &depth,
                Transmission &transmission, BlendPass &blend, SurfaceProbe &probe);

  /** \see draw::Engine::cache_init, cache_populate and cache_finish */
  void begin_sync(std::size_t object_count);
  void sync(draw::ObjectIndex object, bool is_mirrored);
  void end_sync();
  /** Record the calls of all objects anew, unless \a inputs and objects are those of the last recording. */
  void update(render_scene::RenderScene &scene, ShaderCache &shaders, const SurfaceInputs &inputs, const BindLit &bind);
  /** Let the next update() record, because the passes refer to destroyed resources. */
  void forget()
  {
    recorded_.reset();
  }

  /** In the order of their first sync. Recorded when at least one of them is visible. */
  [[nodiscard]] const std::vector<draw::ObjectIndex> &objects() const
  {
    return objects_;
  }
  /** \see Report::pass_recordings */
  [[nodiscard]] std::uint64_t recording_count() const
  {
    return recording_count_;
  }
  [[nodiscard]] bool has_tint() const
  {
    return !tint_pass_.is_empty();
  }

  /** Shades each pixel of forward objects once, by an equal-depth test. */
  [[nodiscard]] FrameStep step();

 private:
  struct Recording {
    render_scene::RenderScene &scene;
    ShaderCache &shaders;
    const SurfaceInputs &inputs;
    const BindLit &bind;
  };
  /** Key of the recording of an object, beside its index. All objects of a mesh are of one kind, or of few. */
  struct Kind {
    gpu::BatchRange batch{};
    /** The groups that have calls of the objects: no more than one in each of five passes. */
    std::array<draw::ShadingGroup *, 5> groups{};
    std::size_t group_count = 0;
    /** The program of BlendPass, where each object has groups of its own; nullptr: they are not in it. */
    const gpu::Shader *blend_shader = nullptr;
  };
  /** Make the groups for the objects of the kind of \a first. */
  Kind record_kind(const Recording &recording, draw::ObjectIndex first);
  /** Inputs of the passes of Inspection for the objects of a kind. */
  struct Inspected {
    render_scene::MaterialClass surface = render_scene::MaterialClass::Plain;
    render_scene::TextureSet textures{};
    FunctionText function{};
    /** Features of a program that lights them. */
    Feature lighting = Feature::None;
    /** LinesOrPoints or None. */
    Feature shape = Feature::None;
    gpu::State state = gpu::State::None;
  };
  void record_inspection(Kind &kind, const Recording &recording, const Inspected &inspected);
  /** Add a group of \a pass to the kind. \a bind binds the resources of a new group, beside \a textures. */
  void add_group(Kind &kind, const Recording &recording, draw::Pass &pass, const gpu::Shader &shader, gpu::State state,
                 render_scene::MaterialClass read, const render_scene::TextureSet &textures, const BindLit &bind);
  void record(const Recording &recording);
  [[nodiscard]] Need need(const FrameState &state) const;

  const RenderBuffers &buffers_;
  DepthPasses &depth_;
  Transmission &transmission_;
  BlendPass &blend_;
  SurfaceProbe &probe_;
  draw::Pass pass_;
  draw::Pass tint_pass_;
  std::vector<draw::ObjectIndex> objects_;
  /** True between begin_sync and end_sync. */
  bool is_collecting_ = false;
  /** By object index: whether the passes were recorded with a mirrored matrix. */
  std::vector<bool> is_mirrored_;
  /** Since the passes were recorded, objects were added or removed, or their winding changed. */
  bool are_objects_changed_ = true;
  std::optional<SurfaceInputs> recorded_;
  std::uint64_t recording_count_ = 0;
  std::map<GroupKey, draw::ShadingGroup *> groups_;
};

}  // namespace gnomon::eevee
