// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_state.hh"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::eevee {

/** Features that a frame may need, derived from the scene. Programs, passes and targets depend on them. */
enum class Feature : std::uint32_t {
  None = 0,
  /** At least one lamp or the world gives light. */
  Light = 1U << 0,
  /** At least one point, spot or area lamp gives light. */
  Punctual = 1U << 1,
  /** At least one material has specular reflection. */
  Specular = 1U << 2,
  /** Cube shadow maps of point lamps, area lamps and wide spots. */
  ShadowCube = 1U << 3,
  /** Planar shadow maps of suns and spots. */
  ShadowMap = 1U << 4,
  /** Percentage-closer filtering of cube or planar shadow maps. */
  ShadowPcf = 1U << 5,
  /** Octahedral exponential shadow maps. */
  ShadowEsm = 1U << 6,
  /** Per material: a texture gives the base colour. */
  BaseColorTexture = 1U << 7,
  /** Per material: fragments whose alpha is below the material's cutoff are discarded. */
  AlphaMask = 1U << 8,
  /** At least one octahedral map is an exponential variance shadow map. */
  ShadowEvsm = 1U << 9,
  /** At least one lamp with an extent is shaded as a whole (LampShading::Whole), or a spot has an elliptical cone. */
  LampShape = 1U << 10,
  /** Per material: its class is render_scene::MaterialClass::Full or a later one. Excludes BaseColorTexture. */
  FullMaterial = 1U << 11,
  /** The target of the picture has a depth buffer that the engine writes. */
  TargetDepth = 1U << 12,
  /** The scene's world gives light. */
  World = 1U << 13,
  /** Per material: it is blended or transmits light. Its shadow layers hold the part of it that its opacity says. */
  OpacityThreshold = 1U << 14,
  /** Per material: its class is render_scene::MaterialClass::Layered or Transmissive. */
  Layers = 1U << 15,
  /** Per material: its class is render_scene::MaterialClass::Transmissive. */
  Transmission = 1U << 16,
  /** Settings::has_multiscatter is set, and at least one material has specular reflection. */
  Multiscatter = 1U << 17,
  /** Pixels visit only the lights that can reach their froxel. The lights are in `light_texture`. */
  LightClusters = 1U << 18,
  /**
   * With several samples, a lamp with an extent may be reflected as a whole (HIGHLIGHT_LOBE_POINTS). It is a constant
   * of programs with LampShape, and selects no variant: their interfaces are the same.
   */
  LampHighlights = 1U << 19,
  /**
   * The surface receives occlusion of the world's light in a picture of one sample. A constant of programs with World,
   * as LampHighlights is of those with LampShape.
   */
  WorldOcclusion = 1U << 20,
  /**
   * The device moves vertices to a coarse grid (gpu::Limits::subpixel_bits). A constant of programs that draw surfaces
   * and casters.
   */
  CoarseGrid = 1U << 21,
  /** The view has clip planes. A constant of programs that write depths, or draw blended surfaces. */
  ClipPlanes = 1U << 22,
  /** Shadow layers show the whole lit surface in each sample. A constant of programs with shadows. */
  SurfaceInLayers = 1U << 23,
  /** Lines or points are drawn. Their programs are without CoarseGrid, which discards what has no area. */
  LinesOrPoints = 1U << 24,
  /** There are Lamps::surface_point_count. A constant of programs with lamps at a distance. */
  SurfacePoints = 1U << 25,
};

GNOMON_MASK_OPERATORS(Feature)

/** At least one lamp has a shadow. */
inline constexpr Feature any_shadow = Feature::ShadowCube | Feature::ShadowMap | Feature::ShadowEsm;

/** Constants of programs. They select no variant. \see constants_of */
inline constexpr Feature program_constants = Feature::LampHighlights | Feature::WorldOcclusion | Feature::CoarseGrid |
                                             Feature::ClipPlanes | Feature::SurfaceInLayers | Feature::SurfacePoints;

/** \a features without those of shadows. */
constexpr Feature without_shadows(Feature features)
{
  return without(features, any_shadow | Feature::ShadowPcf | Feature::ShadowEvsm | Feature::WorldOcclusion |
                               Feature::SurfaceInLayers);
}

/** The kernel of percentage-closer filtering. */
struct PcfKernel {
  static constexpr int taps_max = 64;

  /** Edge of the square kernel, texels: 1, 3 or 5. 0 selects a disk with a radius of 2 texels. */
  int width = 3;
  /** Number of bilinear lookups on the disk, 1 to taps_max. Not used by the square kernels. */
  int taps = 16;

  bool operator==(const PcfKernel &) const = default;
};

/** The kernel that \a text names: 1, 3x3, 5x5, or disk:N with N lookups. Empty for any other text. */
[[nodiscard]] std::optional<PcfKernel> pcf_kernel_of(std::string_view text);
/** The text of \a kernel for pcf_kernel_of. */
[[nodiscard]] std::string text_of(const PcfKernel &kernel);

/** An item of a frame, such as a pass or a texture, whether the engine made it, and the reason. */
struct FrameItem {
  std::string what;
  bool is_made = false;
  std::string why;
};

}  // namespace gnomon::eevee
