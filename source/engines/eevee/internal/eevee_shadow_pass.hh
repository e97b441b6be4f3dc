// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_shaders.hh"
#include "internal/eevee_materials.hh"
#include "internal/eevee_surfaces.hh"

#include <map>

namespace gnomon::eevee {

class SceneShadows;
class Shadows;

/** The pass that draws the casters of a scene's shadows, for all lamps and viewports. Internal to the engine. */
class ShadowPass {
 public:
  ShadowPass(draw::ObjectBuffer &objects, const SceneMaterials &materials, SceneShadows &shadows);
  /** Let the next update give the casters to the shadows again, because these were planned anew. */
  void forget_casters()
  {
    has_casters_ = false;
  }
  /** Let the next update record the pass again, because work was lost. */
  void forget()
  {
    recorded_.reset();
  }
  [[nodiscard]] bool has_casters() const
  {
    return has_casters_;
  }
  /**
   * Record the pass if an input changed, and give the casters among \a objects to the shadows, which compare them with
   * those of the last sync. \a settings_revision: changes whenever the settings do. \a features: of the frame.
   */
  void update(render_scene::RenderScene &scene, ShaderCache &shaders, const Settings &settings,
              std::uint64_t settings_revision, Feature features, std::span<const draw::ObjectIndex> objects);
  /**
   * Draw blended casters for this sample. \return whether they were drawn for another one: between two parts of a
   * sample, another viewport may have drawn; before, the settings may have been others.
   */
  bool set_sample(int index, std::uint32_t seed);

  [[nodiscard]] const draw::Pass &pass() const
  {
    return pass_;
  }
  /** Blended objects cast other shadows in each sample. */
  [[nodiscard]] bool has_blended() const;

 private:
  /** Key of the shadow of a caster, beside its matrix: all casters of a mesh and winding are of one kind. */
  struct Kind {
    scene::Handle<scene::Mesh> handle;
    /** The call in the pass; nullptr: the mesh casts no shadow, because it has no triangles. */
    draw::InstanceCall *instances = nullptr;
    /** \see Caster. It changes without a new recording. */
    bool is_blended = false;
  };
  /** Revisions of everything that the pass depends on. */
  struct Key {
    std::uint64_t structure = 0;
    std::uint64_t passes = 0;
    std::uint64_t settings = 0;
    std::uint64_t shaders = 0;
    bool has_shadows = false;

    bool operator==(const Key &) const = default;
  };
  void record(render_scene::RenderScene &scene, ShaderCache &shaders, const Settings &settings, const Key &key,
              std::span<const draw::ObjectIndex> objects);
  /** Make the call for the casters of the kind of \a first. */
  Kind record_kind(render_scene::RenderScene &scene, ShaderCache &shaders, const Settings &settings,
                   draw::ObjectIndex first);
  void add_casters(render_scene::RenderScene &scene, std::span<const draw::ObjectIndex> objects);

  const SceneMaterials &materials_;
  SceneShadows &shadows_;
  draw::Pass pass_;
  std::map<GroupKey, draw::ShadingGroup *> groups_;
  std::vector<Kind> kinds_;
  /** By object index: the number of its kind, from 1; 0 for objects that cast no shadow. */
  std::vector<std::uint32_t> kind_of_;
  /** By object index: whether the caster was recorded with a mirrored matrix. */
  std::vector<bool> is_mirrored_;
  std::optional<Key> recorded_;
  /** The shadows have the casters of the last sync. */
  bool has_casters_ = false;
  /** Sample for which blended casters are drawn; the pass reads both by reference. */
  int sample_index_ = 0;
  int sample_seed_ = 0;
};

/**
 * The step that draws the layers of \a shadows, those of a viewport, which are out of date. \a feedback: depths of the
 * viewport. All must outlive the step.
 */
[[nodiscard]] FrameStep shadows_step(Shadows &shadows, ShadowPass &pass, const DepthFeedback &feedback);

}  // namespace gnomon::eevee
