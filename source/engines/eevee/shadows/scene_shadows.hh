// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_features.hh"
#include "eevee_shadow_settings.hh"

#include "eevee_light_shared.h"
#include "gpu_device.hh"
#include "scene.hh"

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gnomon::eevee {

struct Caster;
class LayerArray;
class OctahedralStore;
class ShaderCache;
enum class ShadowArrayId : std::uint8_t;
struct ShadowLamp;
class Shadows;
struct VisibleRange;

/**
 * Shadow maps of a scene's lamps on a device, for all viewports: the plan, the casters, the textures, and the layers
 * that do not depend on a view. The class Shadows holds the part that belongs to one viewport.
 *
 * Order of calls: sync; when an object is visible: allocate, add_caster for each caster, finish; then Shadows::update
 * of any viewport. A layer is drawn again if the position, direction, cone, range, shadow size or method of its lamp
 * changes, if a caster that touches the layer changes, or if the layer is fitted to a view and the fit changes. The
 * lamp's name, colour, intensity, bias and PCF filter do not affect texels.
 */
class SceneShadows {
 public:
  SceneShadows();
  SceneShadows(const SceneShadows &) = delete;
  SceneShadows &operator=(const SceneShadows &) = delete;
  ~SceneShadows();

  /**
   * Plan the shadows of \a lamps, and write shadow_kind and shadow_index of their entries in \a lights. Creates no
   * resources on the device. \a bounds_ws: bounds of the scene. \a lights: Lamps::lights.
   *
   * \throws gpu::Error if a setting is out of range. It names the setting, and the lamp if the setting is that of a
   * lamp. Nothing has changed then.
   */
  void sync(const gpu::Limits &device_limits, std::span<const ShadowLamp> lamps, const scene::Bounds &bounds_ws,
            std::span<shared::LightData> lights, const ShadowSettings &settings);
  /** Create the resources of the plan and free those that are no longer needed. \a shaders: for the filter passes. */
  void allocate(gpu::Device &device, ShaderCache &shaders);
  void add_caster(const Caster &caster);
  /** Call after the last add_caster. */
  void finish();
  /** Mark all layers as out of date, for example because the shaders changed. */
  void invalidate();

  /** Changes when a viewport is added or removed. Another sync is then required, because each viewport has own maps. */
  [[nodiscard]] std::uint64_t viewports_revision() const
  {
    return viewports_revision_;
  }

  /** The buffer range for `shadow_render_block` of the pass that draws casters. It must be bound by reference. */
  [[nodiscard]] const gpu::BufferRange *render_block() const
  {
    return &render_block_;
  }
  /** The method that the shaders of the pass that draws casters must implement. Never LayerPass::Best. */
  [[nodiscard]] LayerPass layer_pass() const
  {
    return layer_pass_;
  }
  /** Features that shaders need for the shadows of the lamps. Valid after sync. */
  [[nodiscard]] Feature features() const;

  [[nodiscard]] const gpu::Texture &cubes() const;
  /** Created by the first Shadows::update, because the number of layers depends on the views. */
  [[nodiscard]] const gpu::Texture &maps() const;
  [[nodiscard]] const gpu::Texture &distance_cube() const;
  /** The buffer with the matrices for drawing casters: one ShadowRenderBlock for each lamp with a shadow. */
  [[nodiscard]] const gpu::Buffer &render_blocks() const
  {
    return render_buffer_;
  }
  /** \see ShadowPlan */
  [[nodiscard]] const std::vector<std::string> &warnings() const;
  [[nodiscard]] const std::vector<std::string> &limits() const
  {
    return limits_;
  }
  /** Number of triangles that were visited to compute the distances of near planes, since the start. */
  [[nodiscard]] std::uint64_t triangles_visited() const;
  [[nodiscard]] std::size_t cube_count() const;
  [[nodiscard]] std::size_t map_count() const;
  [[nodiscard]] std::size_t esm_count() const;
  [[nodiscard]] const OctahedralStore &octahedral() const;

 private:
  friend class Shadows;

  /** The members whose types only shadows need to know. */
  struct State;

  [[nodiscard]] const LayerArray &array(ShadowArrayId id) const;
  [[nodiscard]] std::size_t lamp_count(ShadowArrayId id) const;
  /** Calls \a action with the shared slots and with the slots of all viewports. */
  template <typename Action>
  void for_each_slot(Action &&action);
  /** Calls \a action with the slots whose layers are in the array of cubes. */
  template <typename Action>
  void for_each_cube(Action &&action);
  void resize(gpu::Device &device, ShadowArrayId id, int layers);
  void place_render_blocks(gpu::Device &device);
  /** Assign layers to the faces of each cube that the surfaces of a view look up, if maps are fitted. */
  void place_cubes(gpu::Device &device, const VisibleRange &visible);
  void place_maps(gpu::Device &device);
  void choose_map_format();

  ShadowSettings settings_;
  LayerPass layer_pass_ = LayerPass::Single;
  std::unique_ptr<State> state_;
  std::vector<Shadows *> viewports_;
  std::uint64_t viewports_revision_ = 0;
  /** \see VisibleRange::revision */
  std::uint64_t last_visible_revision_ = 0;
  /** LayerOwner::viewport of the viewport that was added last. */
  std::uint64_t last_viewport_ = 0;
  /** Bounds of all objects: those that cast no shadow can receive one. */
  scene::Bounds bounds_ws_;
  gpu::Sampler sampler_;
  gpu::Buffer render_buffer_;
  gpu::BufferRange render_block_;
  std::vector<std::string> limits_;
};

}  // namespace gnomon::eevee
