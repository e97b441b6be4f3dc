// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_debug.hh"
#include "internal/eevee_adaptive.hh"
#include "internal/eevee_background.hh"
#include "internal/eevee_blend.hh"
#include "internal/eevee_depth.hh"
#include "internal/eevee_film.hh"
#include "internal/eevee_frame.hh"
#include "internal/eevee_lights.hh"
#include "internal/eevee_lut.hh"
#include "internal/eevee_materials.hh"
#include "internal/eevee_scene_world.hh"
#include "internal/eevee_shadow_pass.hh"
#include "internal/eevee_surfaces.hh"
#include "internal/eevee_target.hh"
#include "internal/eevee_transmission.hh"
#include "internal/eevee_view_lights.hh"
#include "shadows/shadows.hh"

#include "draw_viewport.hh"

#include <memory>

/** The engine's data in a viewport. Internal to the engine. */
namespace gnomon::eevee {

/** All that a picture depends on, except the view and the size. Each has an owner that alone sees its changes. */
struct PictureKey {
  /** RenderScene::revision. */
  std::uint64_t scene = 0;
  /** Engine::settings_revision. */
  std::uint64_t settings = 0;
  /** ShaderCache::revision. */
  std::uint64_t shaders = 0;

  bool operator==(const PictureKey &) const = default;
};

/** The modules that all viewports of a scene share. They are destroyed with the last viewport. */
struct SharedData {
  explicit SharedData(draw::ObjectBuffer &objects) : shadow_pass(objects, materials, shadows) {}
  SceneMaterials materials;
  LookupTables tables;
  SceneWorld world;
  SceneLights lights{world};
  SceneShadows shadows;
  ShadowPass shadow_pass;
  /** gpu::Device::loss_count up to which lost submissions were handled. */
  std::uint64_t loss_count = 0;
};

/** The modules of a viewport, and the rest of its state. */
struct Data final : draw::EngineViewportData {
  /** \a shared_data: of the engine. Empty or destroyed: this viewport is the first. */
  Data(render_scene::RenderScene &scene, std::weak_ptr<SharedData> &shared_data);
  void resized() override;
  [[nodiscard]] FrameState state(const Settings &settings) const;
  /** Bind the resources that a program with lighting reads, except the textures of the material. */
  void bind_lit(draw::ShadingGroup &group) const;

  /** It must outlive the modules of the viewport. */
  std::shared_ptr<SharedData> shared;
  ViewLights lights;
  Shadows shadows;
  Film film;
  RenderBuffers buffers;
  DepthPasses depth;
  AdaptiveSampling adaptive{film, buffers, depth};
  BackgroundPass background;
  Transmission transmission;
  BlendPass blend;
  SurfaceProbe probe;
  SurfacePasses surfaces;
  DrawnMaterials materials;
  TargetOutput output{film, buffers};
  ShadowPicture shadow_picture;
  /** The last member that its steps refer to is before it. */
  Frame frame;

  /** Features that the programs of the frame have. */
  Feature features = Feature::None;
  /** SceneLights::revision from which `features` was derived. */
  std::uint64_t lights_revision = 0;
  std::optional<PictureKey> synced_picture;
  /** The visible objects of the view that was recorded last. */
  draw::VisibleObjects visible;
  int sample_index = 0;
  /** gpu::Device::loss_count up to which lost submissions of this viewport were handled. */
  std::uint64_t loss_count = 0;
  /** The last sync and the recording after it did not fail. Otherwise drawing throws. */
  bool is_synced = false;
  /** Passes, programs and targets are up to date: an object or a background was visible since the last sync. */
  bool is_recorded = false;
  /** The last drawn view has clip planes. */
  bool is_clipped = false;
  /** Programs with and without clip planes are others. Call this before passes for \a view are recorded. */
  void follow_clip(const draw::View &view)
  {
    is_recorded &= is_clipped == !view.clip_planes().empty() && (transmission.hidden() == view.hidden());
    is_clipped = !view.clip_planes().empty();
    transmission.set_hidden(view.hidden());
  }
  /** An object or a background was visible in at least one sample of the current picture. */
  bool is_seen = false;
  /** An object of DrawnMaterials::transmissive is in the view of the current sample. */
  bool is_transmission_seen = false;
};

}  // namespace gnomon::eevee
