// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_casters.hh"
#include "shadow_plan.hh"
#include "shadow_settings.hh"
#include "shadow_technique.hh"

#include "draw_pass.hh"

#include <array>
#include <vector>

namespace gnomon::eevee {

class Shadows;

/**
 * Shadow maps of a scene's lamps on a device, for all viewports: the plan, the casters, the textures, and the layers
 * that depend on no view. Shadows is the part of one viewport.
 *
 * Order of calls: sync; once anything is seen, allocate, add_caster for each, finish; then Shadows::update of any
 * viewport. A layer is drawn again where its lamp's place, direction, cone, range, size or method changes, where a
 * caster that touches it changes, or where its view follows what is seen. The lamp's name, colour, intensity, bias and
 * filter change no texel.
 */
class SceneShadows {
 public:
  SceneShadows() = default;
  SceneShadows(const SceneShadows &) = delete;
  SceneShadows &operator=(const SceneShadows &) = delete;

  /**
   * Plan the shadows of \a lamps and write shadow_kind and shadow_index of their entries in \a light_block. Creates
   * nothing on the device. \a bounds_ws: of the scene.
   *
   * \throws gpu::Error naming lamp and setting where a setting is out of range.
   */
  void sync(const gpu::Limits &device_limits, std::span<const ShadowLamp> lamps, const scene::Bounds &bounds_ws,
            shared::LightBlock &light_block, const ShadowSettings &settings);
  /** Create what the last sync planned, and free what is not needed any more. \a shaders: for the filter passes. */
  void allocate(gpu::Device &device, ShaderCache &shaders);
  void add_caster(const Caster &caster)
  {
    casters_.add(caster);
  }
  /** After the last caster. */
  void finish();
  /** Draw everything again, because the shaders changed, for example. */
  void invalidate();

  /** Changes with each viewport that comes or goes: then another sync is due, as each has maps of its own. */
  [[nodiscard]] std::uint64_t viewports_revision() const
  {
    return viewports_revision_;
  }

  /** To be bound by reference in the pass that draws casters, as `shadow_render_block`. */
  [[nodiscard]] const gpu::BufferRange *render_block() const
  {
    return &render_block_;
  }
  /** The method that the shader of the pass that draws casters must have; never Best. */
  [[nodiscard]] LayerPass layer_pass() const
  {
    return layer_pass_;
  }
  /** What the shaders need for the lamps' shadows; valid after sync. */
  [[nodiscard]] Feature features() const;

  [[nodiscard]] const gpu::Texture &cubes() const
  {
    return array(ShadowArrayId::Cubes).texture();
  }
  /** Created by the first update: the number of layers depends on the views. */
  [[nodiscard]] const gpu::Texture &maps() const
  {
    return array(ShadowArrayId::Maps).texture();
  }
  [[nodiscard]] const gpu::Texture &distance_cube() const
  {
    return array(ShadowArrayId::DistanceCube).texture();
  }
  /** The views that casters are drawn with, one block for each lamp. */
  [[nodiscard]] const gpu::Buffer &render_blocks() const
  {
    return render_buffer_;
  }
  /** \see ShadowPlan */
  [[nodiscard]] const std::vector<std::string> &warnings() const
  {
    return plan_.warnings;
  }
  [[nodiscard]] const std::vector<std::string> &limits() const
  {
    return limits_;
  }
  /** Triangles of casters visited to find near planes. */
  [[nodiscard]] std::uint64_t triangles_visited() const
  {
    return casters_.distances().triangles_visited();
  }
  [[nodiscard]] std::size_t cube_count() const
  {
    return lamp_count(ShadowArrayId::Cubes);
  }
  [[nodiscard]] std::size_t map_count() const
  {
    return lamp_count(ShadowArrayId::Maps);
  }
  [[nodiscard]] const OctahedralStore &octahedral() const
  {
    return octahedral_;
  }

 private:
  friend class Shadows;

  [[nodiscard]] const LayerArray &array(ShadowArrayId id) const
  {
    return arrays_[std::size_t(id)];
  }
  [[nodiscard]] std::size_t lamp_count(ShadowArrayId id) const;
  /** Calls \a action with the slots of all viewports and those that they share. */
  template <typename Action>
  void for_each_slot(Action &&action);
  void resize(gpu::Device &device, ShadowArrayId id, int layers);
  void place_render_blocks(gpu::Device &device);
  void place_maps(gpu::Device &device);

  ShadowSettings settings_;
  LayerPass layer_pass_ = LayerPass::Single;
  ShadowPlan plan_;
  /** Of the lamps whose layers serve all viewports, in the order of the lamps. */
  std::vector<ShadowSlot> slots_;
  std::vector<Shadows *> viewports_;
  std::uint64_t viewports_revision_ = 0;
  /** LayerOwner::viewport of the last one that came. */
  std::uint64_t last_viewport_ = 0;
  ShadowCasters casters_;
  /** By ShadowArrayId. */
  std::array<LayerArray, shadow_array_count> arrays_ = {LayerArray("shadow_cubes", gpu::Format::Depth32F),
                                                        LayerArray("shadow_maps", gpu::Format::Depth32F),
                                                        LayerArray("shadow_distance_cube", gpu::Format::Depth32F)};
  std::array<draw::TextureBinding, shadow_array_count> bindings_;
  LayerRuns map_runs_;
  /** What each lamp with an octahedral layer asks for. */
  std::vector<EsmLamp> esm_lamps_;
  OctahedralStore octahedral_;
  gpu::Sampler sampler_;
  gpu::Buffer render_buffer_;
  gpu::BufferRange render_block_;
  std::vector<std::string> limits_;
};

}  // namespace gnomon::eevee
