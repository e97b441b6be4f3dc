// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_features.hh"
#include "eevee_shaders.hh"
#include "shadows/shadows.hh"

#include "draw_engine.hh"
#include "draw_viewport.hh"
#include "render_scene.hh"
#include "render_surfaces.hh"

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

/** A part of the light of a picture. The parts of all lamps, of the world and of emission sum to the picture. */
struct LightPart {
  enum class Kind {
    All,
    /** One lamp. */
    Lamp,
    /** The world and the background. */
    World,
    /** Light that surfaces emit: what the camera sees of it, and what it gives to other surfaces. */
    Emission,
  };
  Kind kind = Kind::All;
  /** Index in RenderScene::lamps, for Kind::Lamp. */
  std::size_t lamp = 0;

  [[nodiscard]] bool has(Kind part) const
  {
    return kind == Kind::All || kind == part;
  }
};

/** Number of samples for which pictures without a sample count are approximated. \see Settings::sample_count */
inline constexpr int open_ended_sample_count = 256;
/** Most points of emissive surfaces in a sample. \see Settings::emissive_point_count */
inline constexpr int emissive_point_max = 16;

/** Names, units and limits are in eevee_settings.hh. */
struct Settings {
  ShadowSettings shadow{};
  Background background{};
  /**
   * Draw only this part of the light. Sample positions, shadows, points of lamps and blended surfaces remain those of
   * the picture with all light.
   */
  LightPart light{};
  /**
   * Samples for each pixel of a complete picture. 0: no limit; the host ends the picture with Engine::finish.
   * Approximations that depend on the number of samples then assume `open_ended_sample_count`.
   */
  int sample_count = 1;
  /**
   * Draw only the samples from `sample_first` to `sample_end` - 1 of the picture, for pictures that are drawn in parts;
   * `sample_end` 0: to the last. \pre 0 <= sample_first < sample_end <= sample_count, or both are 0. \see sample_share
   */
  int sample_first = 0;
  int sample_end = 0;
  /** Selects the random sequence of sample positions and lamp points. */
  std::uint32_t seed = 0;
  /**
   * Adaptive sampling: after the first samples (half of them, at most 4), only those pixels get further samples that
   * differ from one of the eight around them by more than this, relative to the square root of their brightness, or in
   * alpha. Thin objects that the first samples miss are lost. 0: all pixels get all samples. All pixels get them, too,
   * in scenes with lamps with an extent, a world, emissive surfaces, surfaces that transmit light or blended objects
   * that cast shadows, and where a part of the light or a region is drawn. \pre sample_first and sample_end are 0,
   * unless this is 0
   */
  float noise_threshold = 0.0F;
  /**
   * Microfacets reflect light more than once, so that a rough surface loses none: a white one in a white world is
   * white. Otherwise they reflect it once, as glTF's model has it. \see eevee_multiscatter_shared.h
   */
  bool has_multiscatter = false;
  /**
   * With several samples, each draws the light that this number of points of emissive surfaces give to other surfaces,
   * with their shadows, up to `emissive_point_max`. 0, and pictures of one sample: emissive surfaces give no light to
   * others.
   */
  int emissive_point_count = 4;
  /** Measure the time of each step on the device. */
  bool is_timed = false;
  /**
   * Irradiance, W/m², below which a lamp may be left out: the range of points and spots is lowered to the distance
   * beyond which they give less. The irradiance of each lamp is too small by at most this. There is no bound for the
   * highlights of smooth surfaces. 0: no light is left out.
   */
  float light_threshold = 0.0F;
  /**
   * The number of lamps with a range from which on pixels visit only the lamps that can reach them, by lists for the
   * parts of the view. With more than LIGHT_MAX lamps it is always so. The picture does not depend on it, up to
   * rounding. At least 1.
   */
  int clustered_lamps_min = 8;
  /** Multiply the picture by a colour for each cascade of the first sun that has a shadow. */
  bool has_cascade_tint = false;
  /** Enables Inspection::probe, which needs additional targets and a pass. */
  bool has_probe = false;
  /** Enables Inspection::surfaces, which needs additional targets and a pass. */
  bool has_surfaces = false;

  [[nodiscard]] int planned_sample_count() const
  {
    return sample_count == 0 ? open_ended_sample_count : sample_count;
  }
  /** All but the shadow's. \see eevee_settings.hh */
  template <typename Visit>
  static constexpr void for_each_property(Visit &&visit);

  /** Number of samples that are drawn, of a picture with a known number of samples; otherwise 0. */
  [[nodiscard]] int drawn_sample_count() const
  {
    return (sample_end == 0 ? sample_count : sample_end) - sample_first;
  }
};

/**
 * Settings of a picture for which there is time, as `gnomon render` draws it: \a sample_count samples, 0 for no limit,
 * with shadow maps that are as fine as these samples show. For one sample they are smaller than those of Settings, and
 * from 16 samples on larger, and fitted to the visible surfaces (ShadowSettings::is_fitted_to_depth). For views that
 * move, Settings has shadows whose edges keep their place.
 */
[[nodiscard]] Settings offline_settings(int sample_count);

struct CasterKind;
struct Data;
struct ObjectKind;
struct PictureKey;
struct SharedData;
struct StorageList;

/**
 * Draws a scene lit by its lamps with shadow maps and by its world. GPU resources are created by the first draw in
 * which an object or a background is visible. A view without both costs one clear. eevee_frame.cc lists the steps of a
 * frame.
 *
 * Each call of draw_scene (through draw::Viewport::draw) with the same view draws one sample, or a part of it, until
 * the picture has `sample_count` samples or finish ends it. The engine offsets the samples within the pixels. Each call
 * writes the mean of the samples so far to the viewport's target, if it has one.
 */
class Engine final : public draw::Engine {
 public:
  /**
   * \a scene must outlive the engine, and the viewports that it draws in. After an edit of the scene call
   * render_scene::RenderScene::update, then draw::Viewport::sync with the objects of \a scene.
   */
  Engine(render_scene::RenderScene &scene, const Settings &settings)
      : scene_(scene), settings_(settings), shaders_(std::make_shared<ShaderCache>())
  {
  }
  /**
   * An engine for the scene of \a other that shares its programs, so that what one has compiled the other need not.
   * Both have the same kernel of percentage-closer filtering (ShadowSettings::pcf), and reload_shaders of one is
   * followed by a sync of the viewports of both. Either may be destroyed first.
   */
  Engine(const Engine &other, const Settings &settings)
      : scene_(other.scene_), settings_(settings), shaders_(other.shaders_)
  {
  }

  /** Set other settings. They take effect with the next draw::Viewport::sync, which must precede the next draw. */
  void set_settings(const Settings &settings)
  {
    settings_ = settings;
    settings_revision_++;
  }

  [[nodiscard]] const Settings &settings() const
  {
    return settings_;
  }
  /** Increased by set_settings. */
  [[nodiscard]] std::uint64_t settings_revision() const
  {
    return settings_revision_;
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

  /**
   * The scene-linear picture, RGBA32F, to be multiplied by radiance_scale. Pixels outside of draw::Viewport::region are
   * undefined. \throws gpu::Error if the viewport was not synced since it was made or resized
   */
  [[nodiscard]] const gpu::Texture &radiance(draw::Viewport &viewport) const;
  /** Factor from radiance to the mean of the samples so far. 1 if the picture has Settings::sample_count samples. */
  [[nodiscard]] float radiance_scale(draw::Viewport &viewport) const;
  /**
   * Sum of the filter weights of the samples so far, as a share of those of all Settings::sample_count samples: 1 for a
   * whole picture. A picture is the mean of its parts, weighted by their shares. Not a share if Settings::sample_count
   * is 0.
   */
  [[nodiscard]] double sample_share(draw::Viewport &viewport) const;
  /** Whether the picture has all of its samples, so that further draws would not change it. */
  [[nodiscard]] bool is_complete(draw::Viewport &viewport) const;
  /**
   * End the current picture with the samples drawn so far. Further draws add no sample until the picture begins anew;
   * they write the picture to their target. No effect on a picture without samples.
   */
  void finish(draw::Viewport &viewport) const;
  /**
   * Compile all programs again from \a files, for hosts that edit shaders. Then call draw::Viewport::sync.
   * \return one message for each program that does not compile and keeps its last state. \see ShaderCache::reload
   */
  std::vector<std::string> reload_shaders(draw::Viewport &viewport, gpu::ShaderFiles files,
                                          gpu::ShaderReflection reflection);

 private:
  friend class Inspection;

  /** Create the film and its framebuffer. */
  void make_film(draw::Viewport &viewport);
  /** Start of a draw. \throws gpu::Error if the viewport was not synced, or its last sync failed. */
  void begin_draw(draw::Viewport &viewport);
  /** The key of a picture of the current state, for StorageList::synced_picture. */
  [[nodiscard]] PictureKey picture_key() const;
  /** If submitted work was lost, invalidate all results that it may have contained. */
  void take_losses(draw::Viewport &viewport);
  void sync_lamps(SharedData &shared, const gpu::Limits &device_limits);
  /** Create the resources and record the passes of a picture with a visible object, as far as their inputs changed. */
  void record(draw::Viewport &viewport);
  void make_targets(draw::Viewport &viewport);
  /** Derive StorageList::material_features, widest_class and transmissive if their inputs changed. */
  void sync_materials(StorageList &stl) const;
  void make_blocks(draw::Viewport &viewport);
  void record_passes(draw::Viewport &viewport);
  /** Features of programs that settings ask for. */
  [[nodiscard]] Feature asked_features() const
  {
    return settings_.has_multiscatter ? Feature::Multiscatter : Feature::None;
  }
  /** Record the calls of all objects. */
  void record_objects(draw::Viewport &viewport);
  /** Make the groups for the objects of the kind of \a first. */
  ObjectKind record_kind(draw::Viewport &viewport, draw::ObjectIndex first);
  /**
   * Whether the scene has deferred lighting: at least half of its meshes allow it. Where forward objects hide deferred
   * ones, pixels are lit twice. Objects are not counted, so that edits of them do not change the programs.
   */
  [[nodiscard]] bool is_scene_deferred(Feature features) const;
  /** Whether the object is drawn into the G-buffer. It must also receive shadows, as all others there do. */
  [[nodiscard]] bool is_lit_deferred(const StorageList &stl, const render_scene::RenderObject &object) const;
  void record_deferred_lit(draw::Viewport &viewport);
  /** Append the calls of an object that is blended: its backs, if they are drawn, and its fronts. */
  void record_blended(Data &data, draw::ObjectIndex object, const ObjectKind &kind);
  /** Let the blended objects be drawn from back to front, as \a view sees them. */
  void order_blended(Data &data, const draw::View &view);
  /** Record the film in \a pass: PassList::film_pass or film_sampled_pass. */
  void record_film(draw::Viewport &viewport, draw::Pass &pass);
  /** Create what adaptive sampling needs, or destroy it. */
  void make_adaptive(draw::Viewport &viewport);
  void record_adaptive(draw::Viewport &viewport);
  void record_background(draw::Viewport &viewport);
  void record_casters(Data &data);
  /** Make the call for the casters of the kind of \a first. */
  CasterKind record_caster_kind(SharedData &shared, draw::ObjectIndex first);
  void record_tonemap(draw::Viewport &viewport, const draw::View &view);
  /** \return false if only the steps for the device's feedback were drawn, because the feedback changes the picture. */
  bool draw_sample(draw::Viewport &viewport, const draw::View &view);
  void draw_target(draw::Viewport &viewport, const draw::View &view);
  void add_casters(Data &data);
  void update_view(Data &data, const draw::View &view);
  [[nodiscard]] bool has_all_samples(const Data &data, int samples_drawn) const;
  /** \see radiance_scale */
  [[nodiscard]] float sample_scale(const Data &data, int samples_drawn) const;

  render_scene::RenderScene &scene_;
  Settings settings_;
  std::uint64_t settings_revision_ = 0;
  /** Shared by all viewports, and with engines that were made from this one. */
  std::shared_ptr<ShaderCache> shaders_;
  /** Owned by the viewports that draw with this engine. */
  std::weak_ptr<SharedData> shared_;
};

/** The entry of this engine in a host's registry. \a scene must outlive all engines that the entry creates. */
[[nodiscard]] draw::EngineType engine_type(render_scene::RenderScene &scene, const Settings &settings);

}  // namespace gnomon::eevee
