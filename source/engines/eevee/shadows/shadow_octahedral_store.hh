// SPDX-License-Identifier: MIT
#pragma once

#include "shadow_layer_runs.hh"
#include "shadow_storage.hh"

#include "eevee_shaders.hh"

#include "draw_pass.hh"
#include "eevee_esm_shared.h"

#include <optional>

namespace gnomon::eevee {

/** What a layer holds of its distances. */
enum class EsmMethod {
  /** The mean of exp(c·z): sharp, and lit behind a caster over a length of 1 / c. */
  Esm,
  /**
   * And its variance: an exponential variance shadow map, in two channels. Better where the filter is wide, at twice
   * the memory.
   */
  Evsm,
};

/** How a layer is filtered. All are exact in log space: filtered is exp(exponent · distance). */
enum class EsmKernel {
  /** Cones of one solid angle, sampled by 4 and by 32 taps; the cost is taps × texels. */
  Disk4,
  Disk32,
  /**
   * A Gaussian along rows, then along columns, with the disk's variance: for wide filters. Its shape follows the map's
   * texels: its angle is 0.88 to 1.23 of the disk's over the map.
   */
  Separable,
};

enum class EsmFormat {
  /** Half where it rounds visibilities by esm_half_error_max at most. */
  Auto,
  Half,
  Float,
};

/** Most that 16 bits may change a visibility without a word. */
inline constexpr float esm_half_error_max = 0.02F;

/** What one lamp asks for. */
struct EsmSettings {
  EsmMethod method = EsmMethod::Esm;
  /** 1/m, 0.01 to 1e4; nothing: esm_exponent. */
  std::optional<float> exponent{};
  /** Scale of shared::esm_bias, 0 to 1e3. */
  float bias = 1.0F;
  /** Half the opening of the filter's cone, radians, 0 to 0.5; nothing: esm_filter_angle. */
  std::optional<float> filter_angle{};
  /** Edge of the map, texels, 4 to 8192. */
  int size_px = 512;
  /** Of Esm; Evsm has 32 bits. */
  EsmFormat format = EsmFormat::Auto;
  /** Over the derived angle four taps are as good as 32, in a quarter of the time. */
  EsmKernel kernel = EsmKernel::Disk4;
};

/** Half a texel of mean solid angle, radians: the cone is a texel across, as lookups blend four texels anyhow. */
[[nodiscard]] float esm_filter_angle(int size_px);

/**
 * 1/m. Over a cone of half opening a, a plane tilted by 45° spreads over ± a·d at distance d, and the filter's weights
 * over exp(± c·a·d). With a larger exponent c the farthest tap wins, and shadows shrink by the cone; with a smaller one
 * light comes through behind near casters, over a length of 1 / c. At half the range c·a·d is 0.5 for Esm, where a is a
 * texel at least, and 1/16 for Evsm, whose bound needs no steepness: found by sweeps against exact rays
 * (doc/decisions/0005).
 */
[[nodiscard]] float esm_exponent(EsmMethod method, float filter_angle, int size_px, float range);

/** Edge of the cube's faces that serves a map of \a size_px, pixels: doc/decisions/0005. */
[[nodiscard]] int esm_cube_size_px(int size_px);

/** A lamp that wants a layer. */
struct EsmLamp {
  /** Named in messages. */
  std::string name;
  /** Metres, above 0, at most 1e30: no farther does it cast or receive a shadow. */
  float range = 0.0F;
  EsmSettings settings{};
  /** Identity of the lamp: the same in each sync, different for every lamp. */
  std::uint64_t key = 0;
};

/** The depths that a layer is made from: reversed, depth = near / distance along the face's axis, and 0 where nothing
 * is. */
struct EsmCube {
  /** Depth32F array of square layers. */
  const gpu::Texture &texture;
  /** The six faces follow it, in OpenGL's order. */
  int first_layer = 0;
  /** Metres, above 0. */
  float near = 0.0F;
  /** Bit f: face f was drawn. What others show is as far as the range. */
  unsigned face_mask = 0x3F;
  /** Share of a face's image that 90° take, in (0, 1]. */
  float uv_scale = 1.0F;
  /** Edge of a face, in the lower left corner of its layer, texels. 0: the whole layer. */
  int size_px = 0;
};

/**
 * Octahedral exponential shadow maps: for each lamp a layer with the filtered distance to the first caster in each
 * direction, which shadow_esm_visibility of eevee_esm_lib.glsl reads.
 *
 * Order: sync; then record whenever a lamp's cube has changed; bind in what is lit. Must go before its device.
 */
class OctahedralStore {
 public:
  OctahedralStore() = default;
  OctahedralStore(const OctahedralStore &) = delete;
  OctahedralStore &operator=(const OctahedralStore &) = delete;

  /**
   * Give each of \a lamps a layer; the index is that in \a lamps and in `esm_block`. Lamps beyond size() have none and
   * are named in limits(). To be called again after a reload of \a shaders, which must outlive the store.
   *
   * A lamp keeps its layer and its texels from one sync to the next while nothing changes that they depend on.
   *
   * \return whether any layer must be recorded; \see must_record
   * \throws gpu::Error naming lamp, setting and value; nothing has changed then.
   */
  bool sync(gpu::Device &device, ShaderCache &shaders, std::span<const EsmLamp> lamps);

  /** What limits() would be after a sync, without making anything. \throws gpu::Error as sync */
  [[nodiscard]] static std::vector<std::string> limits_of(const gpu::Limits &device_limits,
                                                          std::span<const EsmLamp> lamps)
  {
    return plan(device_limits, lamps, {}).limits;
  }

  /** Whether the layer of the \a index-th lamp has to be recorded since the last sync. */
  [[nodiscard]] bool must_record(std::size_t index) const
  {
    return slots_[index].must_record;
  }

  /** Append the passes that make the layer of the \a index-th lamp. \pre index below size() */
  void record(gpu::CommandList &list, std::size_t index, const EsmCube &cube);

  /** `esm_block`, `shadow_esm`, `shadow_esm_half` and `shadow_evsm`, by value. \pre size() is above 0 */
  void bind(draw::ShadingGroup &group) const;

  /** Whether any lamp has EsmMethod::Evsm: then lookups need USE_SHADOW_EVSM. */
  [[nodiscard]] bool has_variance() const
  {
    return bool(arrays_[ESM_VARIANCE].texture());
  }
  /** Lamps that have a layer. */
  [[nodiscard]] std::size_t size() const
  {
    return slots_.size();
  }
  /** What the lamp was given, derived values in place. */
  [[nodiscard]] const shared::EsmData &data(std::size_t index) const
  {
    return block_.lamps[index];
  }
  /** The array that holds the lamp's layer: R32F, R16F, or RG32F of Evsm. */
  [[nodiscard]] const gpu::Texture &texture(std::size_t index) const
  {
    return array_of(index).texture();
  }
  /** Of layers and of what filtering needs besides. */
  [[nodiscard]] std::size_t size_bytes() const;
  /** All that is made, layers first. */
  [[nodiscard]] std::vector<const gpu::Texture *> textures() const;
  /** `esm_block`; empty until a lamp has a layer. */
  [[nodiscard]] const gpu::Buffer &block() const
  {
    return block_buffer_;
  }
  /** Lamps without a layer, and those whose visibility 16 bits round by more than esm_half_error_max; named. */
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
  /** What the separable filter works in: a texture and what draws into it. */
  struct Scratch {
    gpu::Texture texture;
    gpu::Framebuffer framebuffer;
  };

  /** The result of planning, before anything is created for it. */
  struct Plan {
    std::vector<Slot> slots;
    shared::EsmBlock block{};
    std::vector<std::string> limits;
    /** By ESM_…: layers in use, and the edge that they need. */
    Runs runs;
    std::array<int, 3> sizes{};
    /** 0: no lamp needs any. */
    int scratch_size = 0;
    gpu::Format scratch_format = gpu::Format::R32F;
  };

  /** \a runs: the layers of the last sync. */
  [[nodiscard]] static Plan plan(const gpu::Limits &device_limits, std::span<const EsmLamp> lamps, Runs runs);
  /** Whether the lamp in \a slot of a new plan has the texels that it needs. */
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
  /** By ESM_…: floats, halves, variances. */
  Runs runs_;
  std::array<LayerArray, 3> arrays_ = {LayerArray("shadow_esm", gpu::Format::R32F),
                                       LayerArray("shadow_esm_half", gpu::Format::R16F),
                                       LayerArray("shadow_evsm", gpu::Format::RG32F)};
  /** Distances, and their rows filtered. */
  std::array<Scratch, 2> scratch_;
  gpu::Sampler sampler_;
  draw::Pass disk4_{"esm_disk4", gpu::State::WriteColor};
  draw::Pass disk32_{"esm_disk32", gpu::State::WriteColor};
  draw::Pass distance_{"esm_distance", gpu::State::WriteColor};
  draw::Pass separable_{"esm_separable", gpu::State::WriteColor};
  draw::Pass evsm_disk4_{"evsm_disk4", gpu::State::WriteColor};
  draw::Pass evsm_disk32_{"evsm_disk32", gpu::State::WriteColor};
  draw::Pass evsm_separable_{"evsm_separable", gpu::State::WriteColor};
  /** What the passes read when they are recorded. */
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
  /** Of the last sync; framebuffers are created when first drawn into. */
  gpu::Device *device_ = nullptr;
  std::vector<std::string> limits_;
};

}  // namespace gnomon::eevee
