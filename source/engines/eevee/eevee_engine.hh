// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_features.hh"
#include "eevee_frame_tree.hh"
#include "eevee_shaders.hh"
#include "shadows/shadows.hh"

#include "draw_engine.hh"
#include "draw_viewport.hh"
#include "render_scene.hh"

#include <memory>
#include <optional>

namespace gnomon::eevee {

/** What a picture shows where there is no surface. */
struct Background {
  enum class Kind {
    /** Transparent black. */
    None,
    Color,
    /** The world of the scene. The same as None if the scene has no world. */
    World,
  };
  Kind kind = Kind::None;
  /** Linear radiance of Kind::Color. */
  glm::vec3 color{0.0F};
};

struct Settings {
  ShadowSettings shadow{};
  Background background{};
  /** Samples for each pixel of a picture, at least 1. */
  int sample_count = 1;
  /** Selects the arrangement of the samples. */
  std::uint32_t seed = 0;
  /** Measure the time of each step on the device. */
  bool is_timed = false;
  /** Multiply the picture by a colour for each cascade of the first sun that has a shadow. */
  bool has_cascade_tint = false;
  /** Engine::probe may be called. */
  bool has_probe = false;
};

/** Seconds that the device spent on a step of the frame, summed over the samples of a picture. */
struct StepTime {
  std::string step;
  double seconds = 0.0;
};

struct Data;
struct SharedData;

/** The surface at the middle of each pixel and the visibility of one lamp there; rows from the bottom. */
struct Probe {
  /** xyz: position in the coordinates of the render scene, metres; w: visibility of the lamp by its shadow, in [0, 1].
   */
  std::vector<glm::vec4> position_visibility;
  /** xyz: normal of the triangle on the visible side; w: 1. All 0 where there is no surface. */
  std::vector<glm::vec4> normal;
};

/** The content of one viewport's picture: warnings, limits, and everything that was made or left out. */
struct Report {
  std::vector<std::string> warnings;
  std::vector<std::string> limits;
  /** Lamps that give light and request a shadow, and have none because of a limit. */
  int lost_shadow_count = 0;
  std::vector<FramePart> parts;
  /** "frame": programs, passes, targets, blocks, meshes, textures, shadows and draws, as of the last picture. */
  FrameNode tree;
  ShadowCounters shadow_counters;
  /** How often the passes were recorded since the first sync of the viewport. */
  std::uint64_t pass_recordings = 0;
};

/**
 * Lights a scene with its lamps and their shadow maps. GPU resources are created by the first draw in which an object
 * is visible; a view of nothing costs a clear. eevee_frame.cc lists the steps of a frame.
 *
 * One picture takes `sample_count` calls of draw_scene (through draw::Viewport::draw) with one view. The engine offsets
 * the samples within the pixels. Further calls draw no sample; each call writes the mean of the samples so far to the
 * viewport's target, where there is one.
 */
class Engine final : public draw::Engine {
 public:
  /**
   * \a scene must outlive the engine, and the viewports that it draws in. After an edit of the scene call
   * render_scene::RenderScene::update, then draw::Viewport::sync with the objects of \a scene.
   */
  Engine(render_scene::RenderScene &scene, const Settings &settings) : scene_(scene), settings_(settings) {}

  /** Set other settings. They take effect with the next draw::Viewport::sync, which must precede the next draw. */
  void set_settings(const Settings &settings)
  {
    settings_ = settings;
    settings_revision_++;
  }

  [[nodiscard]] std::string_view name() const override
  {
    return "eevee";
  }
  void init(draw::Viewport &viewport) override;
  void cache_init(draw::Viewport &viewport) override;
  void cache_populate(draw::Viewport &viewport, const draw::ObjectBuffer &objects, draw::ObjectIndex object) override;
  void cache_finish(draw::Viewport &viewport) override;
  void draw_scene(draw::Viewport &viewport, const draw::View &view) override;
  bool take_feedback(draw::Viewport &viewport, const gpu::Feedback &feedback) override;

  /** The scene-linear picture, RGBA32F. Complete once all samples are drawn; before, their sum lacks the others. */
  [[nodiscard]] const gpu::Texture &radiance(draw::Viewport &viewport) const;
  /** All samples of the picture are drawn: further draws would change nothing. */
  [[nodiscard]] bool is_complete(draw::Viewport &viewport) const;
  /** Times of the samples whose feedback came since the last call. Empty unless Settings::is_timed. */
  [[nodiscard]] std::vector<StepTime> take_step_times(draw::Viewport &viewport) const;
  /**
   * Positions, normals and the visibility of the \a lamp-th lamp of RenderScene::lamps at each pixel. Nothing where the
   * lamp gives no light, or no object is there. \pre Settings::has_probe
   */
  [[nodiscard]] std::optional<Probe> probe(draw::Viewport &viewport, const draw::View &view, std::size_t lamp);
  /** Edge of a texel of that lamp's shadow at a position, perpendicular to the light, metres; 0: it has none there. */
  [[nodiscard]] double shadow_texel_size(draw::Viewport &viewport, std::size_t lamp,
                                         const glm::dvec3 &position_ws) const;
  /**
   * Names of the layers of that lamp's shadow in the last picture: "0" to "5" for faces of a cube in OpenGL's order,
   * "0" and up for cascades of a sun from the finest, "0" for a spot, "octahedral". Empty where the lamp has no shadow.
   */
  [[nodiscard]] std::vector<std::string> shadow_layers(draw::Viewport &viewport, std::size_t lamp) const;
  /** A picture of one layer, by index, or of all layers. \see ShadowPicture::draw \pre shadow_layers is not empty */
  [[nodiscard]] const gpu::Texture &shadow_picture(draw::Viewport &viewport, std::size_t lamp,
                                                   std::optional<std::size_t> layer = std::nullopt);
  /** Index in RenderScene::lamps of the sun whose cascades Settings::has_cascade_tint shows; valid after a sync. */
  [[nodiscard]] std::optional<std::size_t> tinted_sun(draw::Viewport &viewport) const;
  /** The shadow layers, as of the last draw. \pre the viewport was synced */
  [[nodiscard]] const Shadows &shadows(draw::Viewport &viewport) const;
  /** Linear in the size of the scene: call it for reports, not for every frame. Before the first sync it is empty. */
  [[nodiscard]] Report report(draw::Viewport &viewport) const;
  /** Of the shadow layers that this viewport's draws were the first to need. \pre the viewport was synced */
  [[nodiscard]] const ShadowCounters &shadow_counters(draw::Viewport &viewport) const
  {
    return shadows(viewport).counters();
  }
  /**
   * Compile the programs again, from \a files; for hosts that edit shaders. Call draw::Viewport::sync after it.
   * \return one message for each program that failed and stays as it was. \see ShaderCache::reload
   */
  std::vector<std::string> reload_shaders(draw::Viewport &viewport, gpu::ShaderFiles files,
                                          gpu::ShaderReflection reflection);
  /** Mark all shadows as out of date, to measure the cost of drawing them. */
  void invalidate_shadows(draw::Viewport &viewport) const;
  /** The recorded passes as text; empty before the first draw in which an object is visible. */
  [[nodiscard]] std::string serialize_passes(draw::Viewport &viewport) const;

 private:
  /** Create what every picture is drawn into. */
  void make_film(draw::Viewport &viewport);
  /** Where submitted work was lost: draw and write again all that it may have held. */
  void take_losses(draw::Viewport &viewport);
  void sync_lamps(SharedData &shared, const gpu::Limits &device_limits);
  /** Create the resources and record the passes of a picture with a visible object, as far as their inputs changed. */
  void record(draw::Viewport &viewport);
  void make_targets(draw::Viewport &viewport);
  void make_blocks(draw::Viewport &viewport);
  void record_passes(draw::Viewport &viewport);
  void record_object(draw::Viewport &viewport, draw::ObjectIndex object);
  void record_film(draw::Viewport &viewport);
  void record_background(draw::Viewport &viewport);
  void record_casters(Data &data);
  void record_caster(SharedData &shared, draw::ObjectIndex object);
  void record_tonemap(draw::Viewport &viewport);
  /** \return false if only the steps for the device's feedback were drawn, because the feedback changes the picture. */
  bool draw_sample(draw::Viewport &viewport, const draw::View &view);
  void draw_target(draw::Viewport &viewport, const draw::View &view);
  void add_casters(Data &data);
  void update_view(Data &data, const draw::View &view);

  render_scene::RenderScene &scene_;
  Settings settings_;
  std::uint64_t settings_revision_ = 0;
  /** Shared by all viewports. */
  ShaderCache shaders_;
  std::uint64_t shaders_revision_ = 0;
  /** Owned by the viewports that draw with this engine. */
  std::weak_ptr<SharedData> shared_;
};

/** The entry of this engine in a host's registry. \a scene must outlive all engines that the entry creates. */
[[nodiscard]] draw::EngineType engine_type(render_scene::RenderScene &scene, const Settings &settings);

}  // namespace gnomon::eevee
