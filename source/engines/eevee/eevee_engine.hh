// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_settings.hh"

#include "draw_engine.hh"
#include "draw_viewport.hh"
#include "render_scene.hh"

#include <memory>
#include <string>
#include <vector>

namespace gnomon::eevee {

/**
 * Settings of an offline picture, as `gnomon render` draws it. \a sample_count: samples for each pixel; 0: no limit.
 * For one sample, shadow maps are smaller than those of Settings. For 16 or more samples, and for no limit, they are
 * larger, and fitted to the visible surfaces (ShadowSettings::is_fitted_to_depth). For views that move, use Settings:
 * the edges of its shadows keep their place.
 */
[[nodiscard]] Settings offline_settings(int sample_count);

struct Data;
struct PictureKey;
class SceneEmission;
class ShaderCache;
struct SharedData;

/**
 * Draws a scene lit by its lamps with shadow maps and by its world. GPU resources are created by the first draw in
 * which an object or a background is visible. A view without both costs one clear. eevee_engine_data.cc
 * lists the steps of a frame.
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
  Engine(render_scene::RenderScene &scene, const Settings &settings);
  /**
   * An engine for the scene of \a other. Both share compiled programs and the table of emissive surfaces. Both must
   * have the same kernel of percentage-closer filtering (ShadowSettings::pcf). After reload_shaders of one, the
   * viewports of both must be synced. Either may be destroyed first.
   */
  Engine(const Engine &other, const Settings &settings)
      : scene_(other.scene_), settings_(settings), shaders_(other.shaders_), emission_(other.emission_)
  {
  }

  /**
   * Set other settings. They take effect with the next draw::Viewport::sync, which must precede the next draw. That
   * sync throws gpu::Error, if a value is outside of the limits of its row.
   */
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
   * The scene-linear picture, RGBA32F, W/(sr m²), premultiplied by alpha, to be multiplied by radiance_scale; rows from
   * the bottom. Pixels outside of draw::Viewport::region are undefined, and all pixels before the first draw. \throws
   * gpu::Error if the viewport was not synced since it was made or resized
   */
  [[nodiscard]] const gpu::Texture &radiance(draw::Viewport &viewport) const;
  /** Factor from radiance to the mean of the samples so far. 1 if the picture has Settings::sample_count samples. */
  [[nodiscard]] float radiance_scale(draw::Viewport &viewport) const;
  /**
   * Sum of the filter weights of the samples so far, as a share of those of all Settings::sample_count samples: 1 for a
   * whole picture. A picture is the mean of its parts, weighted by their shares. If Settings::sample_count is 0, the
   * unit is the weight of a sample at the centre of its pixel: the result is about the number of samples so far.
   */
  [[nodiscard]] double sample_share(draw::Viewport &viewport) const;
  /** Whether the picture has all of its samples, or finish ended it, so that further draws would not change it. */
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

  [[nodiscard]] Data &data_of(draw::Viewport &viewport) const;
  /** Start of a draw. \throws gpu::Error if the viewport was not synced, or its last sync failed. */
  void begin_draw(draw::Viewport &viewport);
  /** The key of a picture of the current state, for Data::synced_picture. */
  [[nodiscard]] PictureKey picture_key() const;
  /** If submitted work was lost, invalidate all results that it may have contained. */
  void take_losses(draw::Viewport &viewport);
  /** Plan the lights and their shadows if an input changed. */
  void sync_lights(SharedData &shared);
  /** Create the resources and record the passes of a picture with a visible object, as far as their inputs changed. */
  void record(draw::Viewport &viewport);
  void make_blocks(draw::Viewport &viewport);
  void record_passes(draw::Viewport &viewport);
  /** \return false if only the steps for the device's feedback were drawn, because the feedback changes the picture. */
  bool draw_sample(draw::Viewport &viewport, const draw::View &view);
  void draw_target(draw::Viewport &viewport, const draw::View &view);
  void update_view(const draw::Viewport &viewport, Data &data, const draw::View &view);

  render_scene::RenderScene &scene_;
  Settings settings_;
  std::uint64_t settings_revision_ = 0;
  /** Shared by all viewports, and with engines that were made from this one. */
  std::shared_ptr<ShaderCache> shaders_;
  /** Shared in the same way. */
  std::shared_ptr<SceneEmission> emission_;
  /** Owned by the viewports that draw with this engine. */
  mutable std::weak_ptr<SharedData> shared_;
};

/** The entry of this engine in a host's registry. \a scene must outlive all engines that the entry creates. */
[[nodiscard]] draw::EngineType engine_type(render_scene::RenderScene &scene, const Settings &settings);

}  // namespace gnomon::eevee
