// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gnomon::eevee {

/** What a frame may need. The scene decides which; programs, passes and targets follow. */
enum class Feature : std::uint32_t {
  None = 0,
  /** Any light at all. */
  Light = 1U << 0,
  /** Point, spot or area lamps. */
  Punctual = 1U << 1,
  Specular = 1U << 2,
  ShadowCube = 1U << 3,
  ShadowMap = 1U << 4,
  /** Percentage-closer filtering of them. */
  ShadowPcf = 1U << 5,
  /** Octahedral exponential shadow maps. */
  ShadowEsm = 1U << 6,
  /** Of the material: its base colour is looked up. */
  BaseColorTexture = 1U << 7,
  /** Of the material: its texture's alpha cuts some of it out. */
  AlphaMask = 1U << 8,
  /** Some of the octahedral maps hold variances. */
  ShadowEvsm = 1U << 9,
  /** Lamps that are shaded as a whole, area lamps, or spots of elliptical cones. */
  LampShape = 1U << 10,
  /** Of the material: render_scene::MaterialClass::Full. Excludes BaseColorTexture. */
  FullMaterial = 1U << 11,
  /** The target of the picture takes depth. */
  TargetDepth = 1U << 12,
  /** Light from all around, beside that of lamps. */
  World = 1U << 13,
};

constexpr Feature operator|(Feature a, Feature b)
{
  return Feature(std::uint32_t(a) | std::uint32_t(b));
}
constexpr Feature operator&(Feature a, Feature b)
{
  return Feature(std::uint32_t(a) & std::uint32_t(b));
}
constexpr bool has(Feature mask, Feature bit)
{
  return (mask & bit) != Feature::None;
}

/** Something is drawn from a lamp. */
inline constexpr Feature any_shadow = Feature::ShadowCube | Feature::ShadowMap | Feature::ShadowEsm;

/** As if no lamp cast a shadow. */
constexpr Feature without_shadows(Feature features)
{
  return Feature(std::uint32_t(features) & ~std::uint32_t(any_shadow | Feature::ShadowPcf | Feature::ShadowEvsm));
}

/** The texels that percentage-closer filtering reads. */
struct PcfKernel {
  /** Edge of a square of texels: 1, 3 or 5; 0: a disk of radius 2 instead. */
  int width = 3;
  /** Lookups on the disk, 1 to 64. */
  int taps = 16;

  bool operator==(const PcfKernel &) const = default;
};

/** A part of a frame that was made or left out, and the reason. */
struct FramePart {
  std::string what;
  bool is_made = false;
  std::string why;
};

}  // namespace gnomon::eevee
