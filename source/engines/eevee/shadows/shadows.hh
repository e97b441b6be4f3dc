// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_casters.hh"
#include "shadow_cube.hh"
#include "shadow_plan.hh"
#include "shadow_settings.hh"
#include "shadow_spot.hh"
#include "shadow_technique.hh"

#include "eevee_lamps.hh"

#include "draw_pass.hh"

#include <array>
#include <functional>
#include <optional>
#include <string_view>

namespace gnomon::eevee {

/** Which layers of a light are drawn, and which are not, for reports. */
struct ShadowState {
  /** In light_block. */
  int light = 0;
  /** The array of the layers: "shadow_cubes", "shadow_maps" or "shadow_distance_cube". */
  std::string_view array;
  /** Edge of each, texels. */
  int size_px = 0;
  /** 0: a sun, of which nothing is seen that its casters could darken; or nothing was ever seen. */
  int layer_count = 0;
  /** Drawn and still correct. */
  LayerMask drawn = 0;
  /** The same, and the layers that hold no caster. Nothing visible looks up the other layers. */
  LayerMask up_to_date = 0;
  /** Drawn since begin_picture. */
  LayerMask drawn_now = 0;
};

/**
 * Shadow maps of a scene's lamps in one viewport.
 *
 * Order of calls: sync; once anything is seen, allocate, bind, add_caster for each, finish; then, for each view, update
 * and, once the list that it recorded into is submitted, submitted. A layer is drawn again where its lamp's place,
 * direction, cone, range, size or method changes, where a caster that touches it changes, or where its view follows
 * what is seen. The lamp's name, colour, intensity, bias and filter change no texel.
 */
class Shadows {
 public:
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
  /** Start of a picture, for ShadowState::drawn_now. */
  void begin_picture();

  /**
   * Fit to what \a view sees and record into \a list the layers that are needed and not up to date. \a pass draws the
   * casters' instances; \a pixel_size: see fit_sun. \a read_depths gives the picture's depths, see narrow_to_depths; it
   * is called only where the settings and lamps ask for it and the view changed.
   */
  void update(gpu::Device &device, const draw::View &view, float pixel_size, const draw::Pass &pass,
              gpu::CommandList &list, const std::function<std::vector<float>()> &read_depths = {});
  /**
   * The list of the last update was submitted: what it draws is up to date from now on. Without this call the next
   * update records the same layers again.
   */
  void submitted();

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
  /** Everything that lookups read, for a group whose shader has features(). */
  void bind(draw::ShadingGroup &group) const;
  [[nodiscard]] const gpu::Texture &cubes() const
  {
    return array(ShadowArrayId::Cubes).texture();
  }
  /** Created by the first update: the number of layers depends on the view. */
  [[nodiscard]] const gpu::Texture &maps() const
  {
    return array(ShadowArrayId::Maps).texture();
  }
  [[nodiscard]] const gpu::Texture &distance_cube() const
  {
    return array(ShadowArrayId::DistanceCube).texture();
  }
  /** `shadow_block`, empty without cubes and maps. */
  [[nodiscard]] const gpu::Buffer &block() const
  {
    return shadow_block_buffer_;
  }
  /** The views that casters are drawn with, one block for each lamp. */
  [[nodiscard]] const gpu::Buffer &render_blocks() const
  {
    return render_buffer_;
  }
  /** Edge of a texel of a light's shadow at a place, across the light, metres; 0: it has none there. */
  [[nodiscard]] double texel_size(const shared::LightData &light, const glm::dvec3 &position_ws) const;
  /** Of a light that casts a shadow, as of the last update. */
  [[nodiscard]] std::optional<ShadowLayers> layers(const shared::LightData &light) const;
  /** Of each light that casts a shadow. */
  [[nodiscard]] std::vector<ShadowState> states() const;
  /** Content of `shadow_block`. */
  [[nodiscard]] const shared::ShadowBlock &block_data() const
  {
    return shadow_block_;
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
  [[nodiscard]] const ShadowCounters &counters() const
  {
    return counters_;
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
  [[nodiscard]] const LayerArray &array(ShadowArrayId id) const
  {
    return arrays_[std::size_t(id)];
  }
  [[nodiscard]] std::size_t lamp_count(ShadowArrayId id) const;
  /** nullptr: the light has no shadow. */
  [[nodiscard]] const ShadowSlot *slot_of(const shared::LightData &light) const;
  [[nodiscard]] ShadowInspection inspection(const ShadowSlot &slot) const;
  void take_over(ShadowSlot &slot, std::vector<ShadowSlot> &before) const;
  void resize(gpu::Device &device, ShadowArrayId id, int layers);
  void place_render_blocks(gpu::Device &device);
  void fit_views(gpu::Device &device, const ShadowView &view);
  void place_maps();
  void discard_recorded();
  void write_block(const ShadowSlot &slot);

  ShadowSettings settings_;
  LayerPass layer_pass_ = LayerPass::Single;
  ShadowPlan plan_;
  /** In the order of the lamps. */
  std::vector<ShadowSlot> slots_;
  ShadowCasters casters_;
  /** What visible_ was computed for. */
  std::optional<glm::mat4> seen_clip_from_world_;
  VisibleRange visible_;
  /** By ShadowArrayId. */
  std::array<LayerArray, shadow_array_count> arrays_ = {LayerArray("shadow_cubes", gpu::Format::Depth32F),
                                                        LayerArray("shadow_maps", gpu::Format::Depth32F),
                                                        LayerArray("shadow_distance_cube", gpu::Format::Depth32F)};
  std::array<draw::TextureBinding, shadow_array_count> bindings_;
  /** What each lamp with an octahedral layer asks for. */
  std::vector<EsmLamp> esm_lamps_;
  OctahedralStore octahedral_;
  gpu::Sampler sampler_;
  shared::ShadowBlock shadow_block_{};
  gpu::Buffer shadow_block_buffer_;
  gpu::Buffer render_buffer_;
  bool is_block_dirty_ = true;
  gpu::BufferRange render_block_;
  std::vector<std::string> limits_;
  ShadowCounters counters_;
  /** Of the recorded work. */
  ShadowCounters recorded_counters_;
};

}  // namespace gnomon::eevee
