// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_layer_array.hh"
#include "shadow_layer_runs.hh"

#include "eevee_shaders.hh"
#include "eevee_shadow_settings.hh"

#include "draw_pass.hh"
#include "eevee_esm_shared.h"

#include <optional>

namespace gnomon::eevee {

/** Maximum error of visibilities by 16-bit rounding. OctahedralStore::limits reports larger errors. */
inline constexpr float esm_half_error_max = 0.02F;

/**
 * Default of EsmSettings::filter_angle, radians: half the mean angle of a texel, so that the cone has the diameter of a
 * texel. A wider cone is not needed, because lookups blend four texels. \a size_px: edge of the map, texels.
 */
[[nodiscard]] float esm_filter_angle(int size_px);

/**
 * Default of EsmSettings::exponent, 1/m. Within a cone of half angle a, the distances of a plane that is tilted by 45°
 * vary by ± a·d at distance d, and the filter weights vary by factors of exp(± c·a·d) with the exponent c. If c is too
 * large, the farthest tap dominates and shadows shrink by the radius of the cone. If c is too small, light leaks behind
 * near casters, over a length of 1 / c. The result makes c·a·d at half the range equal to 0.5 for Esm, where a is at
 * least the mean angle of a texel, and to 1/16 for Evsm, whose bound does not need a large exponent. The two values
 * were found by comparison with ray casting (doc/decisions/0005).
 */
[[nodiscard]] float esm_exponent(EsmMethod method, float filter_angle, int size_px, float range);

/** Edge of the cube faces for an octahedral map with the edge \a size_px, texels. \see doc/decisions/0005 */
[[nodiscard]] int esm_cube_size_px(int size_px);

/** The request of a lamp for a layer. */
struct EsmLamp {
  /** Name for messages. */
  std::string name;
  /** Maximum distance of casters and receivers, metres, 1e-6 to 1e30. */
  float range = 0.0F;
  EsmSettings settings{};
  /** Identity of the lamp: unique, and the same in each sync. */
  std::uint64_t key = 0;
};

/** The cube of depths from which a layer is made. Depth = near / distance along the face's axis; 0 for empty texels. */
struct EsmCube {
  /** Depth32F array of square layers. */
  const gpu::Texture &texture;
  /** Layer of the first of six faces, in OpenGL's order. */
  int first_layer = 0;
  /** Distance of the near plane, metres, above 0. */
  float near = 0.0F;
  /** Bit f: face f was drawn. The other faces contain no caster: their distance is the lamp's range. */
  unsigned face_mask = 0x3F;
  /** Fraction of a face's width that its 90° cover, in (0, 1]. \see shared::cube_uv_scale */
  float uv_scale = 1.0F;
  /** Edge of a face in the lower left corner of its layer, texels. 0: the face fills the layer. */
  int size_px = 0;
};

/**
 * Octahedral exponential shadow maps. Each lamp has a layer with the filtered distance to the first caster in each
 * direction, for the function shadow_esm_visibility of eevee_esm_lib.glsl.
 *
 * Order of calls: sync; then record whenever the depths around a lamp have changed; bind for groups that shade
 * surfaces. Must be destroyed before its device.
 */
class OctahedralStore {
 public:
  OctahedralStore() = default;
  OctahedralStore(const OctahedralStore &) = delete;
  OctahedralStore &operator=(const OctahedralStore &) = delete;

  /**
   * Assign a layer to each of \a lamps. The index of a lamp in \a lamps is also its index in `esm_block`. Lamps from
   * index size() on have no layer, and limits() names them. To be called again after a reload of \a shaders. \a shaders
   * must outlive the store.
   *
   * A lamp keeps its layer and texels over several syncs while the values that they depend on do not change.
   *
   * \return whether at least one layer must be recorded; \see must_record
   * \throws gpu::Error with the lamp, the setting and its value if a setting is out of range; nothing has changed then.
   */
  bool sync(gpu::Device &device, ShaderCache &shaders, std::span<const EsmLamp> lamps);

  /** The result of limits() after a sync, without the creation of resources. \throws gpu::Error as sync */
  [[nodiscard]] static std::vector<std::string> limits_of(const gpu::Limits &device_limits,
                                                          std::span<const EsmLamp> lamps)
  {
    return plan(device_limits, lamps, {}).limits;
  }

  /** Whether the last sync requires that the layer of the \a index-th lamp is recorded. */
  [[nodiscard]] bool must_record(std::size_t index) const
  {
    return slots_[index].must_record;
  }

  /** Append the passes that draw the layer of the \a index-th lamp to \a list. \pre \a index is below size() */
  void record(gpu::CommandList &list, std::size_t index, const EsmCube &cube);

  /**
   * Bind `esm_block` by value, and `shadow_esm`, `shadow_esm_half` and `shadow_evsm` by reference: the store must
   * outlive \a group. \pre size() is above 0
   */
  void bind(draw::ShadingGroup &group) const;

  /** Whether at least one lamp has EsmMethod::Evsm. Lookups then need USE_SHADOW_EVSM. */
  [[nodiscard]] bool has_variance() const
  {
    return bool(arrays_[ESM_VARIANCE].texture());
  }
  /** Number of lamps that have a layer. */
  [[nodiscard]] std::size_t size() const
  {
    return slots_.size();
  }
  /** The entry of the \a index-th lamp in `esm_block`, with derived values for the settings that were not given. */
  [[nodiscard]] const shared::EsmData &data(std::size_t index) const
  {
    return block_.lamps[index];
  }
  /** The array texture of the lamp's layer: R32F, R16F, or RG32F for Evsm. */
  [[nodiscard]] const gpu::Texture &texture(std::size_t index) const
  {
    return array_of(index).texture();
  }
  /** Memory of all textures, including those of the separable filter. */
  [[nodiscard]] std::size_t size_bytes() const;
  /** All textures that exist; the arrays of layers come first. */
  [[nodiscard]] std::vector<const gpu::Texture *> textures() const;
  /** `esm_block`; empty until a lamp has a layer. */
  [[nodiscard]] const gpu::Buffer &block() const
  {
    return block_buffer_;
  }
  /** Messages that name lamps without a layer, and lamps whose 16-bit rounding error exceeds esm_half_error_max. */
  [[nodiscard]] const std::vector<std::string> &limits() const
  {
    return limits_;
  }

 private:
  using Runs = std::array<LayerRuns, 3>;
  struct Slot {
    std::uint64_t key = 0;
    EsmKernel kernel = EsmKernel::Disk4;
    EsmMethod method = EsmMethod::Esm;
    bool must_record = true;
  };
  /** A temporary texture of the separable filter, and its framebuffer. */
  struct Scratch {
    gpu::Texture texture;
    gpu::Framebuffer framebuffer;
  };

  /** The result of planning, before the creation of resources. */
  struct Plan {
    std::vector<Slot> slots;
    shared::EsmBlock block{};
    std::vector<std::string> limits;
    /** Indexed by ESM_…: the layers in use. */
    Runs runs;
    /** Indexed by ESM_…: the edge of the array's layers, with borders. */
    std::array<int, 3> sizes{};
    /** Edge of the temporary textures. 0 if no lamp has a separable filter. */
    int scratch_size = 0;
    gpu::Format scratch_format = gpu::Format::R32F;
  };

  /** \a runs: layers in use after the last sync. */
  [[nodiscard]] static Plan plan(const gpu::Limits &device_limits, std::span<const EsmLamp> lamps, Runs runs);
  /** Whether the texels of the lamp from the last sync are valid for \a slot of a new plan. */
  [[nodiscard]] bool has_texels(const Slot &slot, const shared::EsmData &data) const;
  [[nodiscard]] const draw::Pass &pass_of(const Slot &slot) const;
  [[nodiscard]] const LayerArray &array_of(std::size_t index) const
  {
    return arrays_[std::size_t(block_.lamps[index].format)];
  }
  void create_scratch(gpu::Device &device, int size_px, gpu::Format format);
  void record_passes(gpu::Device &device, ShaderCache &shaders);

  std::vector<Slot> slots_;
  shared::EsmBlock block_{};
  gpu::Buffer block_buffer_;
  /** Indexed by ESM_…. */
  Runs runs_;
  std::array<LayerArray, 3> arrays_ = {LayerArray("shadow_esm", gpu::Format::R32F),
                                       LayerArray("shadow_esm_half", gpu::Format::R16F),
                                       LayerArray("shadow_evsm", gpu::Format::RG32F)};
  /** The first texture holds distances, the second holds the distances after the filter along rows. */
  std::array<Scratch, 2> scratch_;
  gpu::Sampler sampler_;
  /** The bindings of `arrays_`. Groups read them by reference. */
  std::array<draw::TextureBinding, 3> bindings_;
  draw::Pass disk4_{"esm_disk4", gpu::State::WriteColor};
  draw::Pass disk32_{"esm_disk32", gpu::State::WriteColor};
  draw::Pass distance_{"esm_distance", gpu::State::WriteColor};
  draw::Pass separable_{"esm_separable", gpu::State::WriteColor};
  draw::Pass evsm_disk4_{"evsm_disk4", gpu::State::WriteColor};
  draw::Pass evsm_disk32_{"evsm_disk32", gpu::State::WriteColor};
  draw::Pass evsm_separable_{"evsm_separable", gpu::State::WriteColor};
  /** Values that the passes read by reference. */
  struct {
    int lamp = 0;
    int first_layer = 0;
    int face_mask = 0;
    float near = 0.0F;
    float uv_scale = 1.0F;
    int cube_size_px = 0;
    int axis = 0;
    draw::TextureBinding cube;
    draw::TextureBinding source;
  } recorded_;
  /** The device of the last sync, for framebuffers, which are created on first use. */
  gpu::Device *device_ = nullptr;
  std::vector<std::string> limits_;
};

}  // namespace gnomon::eevee
