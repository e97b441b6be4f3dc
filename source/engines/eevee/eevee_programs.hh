// SPDX-License-Identifier: MIT
// The engine's programs as data. The build generates their interfaces from it (../interface_tool/), so that this header
// may use no other header of the engine but eevee_features.hh.
#pragma once

#include "eevee_features.hh"

#include "gpu_shader.hh"

#include <span>

namespace gnomon::eevee {

enum class ShaderId {
  Depth,
  Shadow,
  ShadowLayered,
  ShadowGeometry,
  Lit,
  Probe,
  Film,
  BackgroundColor,
  BackgroundWorld,
  Tonemap,
  EsmDistance,
  EsmDisk4,
  EsmDisk32,
  EsmSeparable,
  EvsmDisk4,
  EvsmDisk32,
  EvsmSeparable,
  DebugShadow,
  DebugCascades,
};

/** A program of the engine as data. The engine, the build, the checks and the tests read it. */
struct ShaderDeclaration {
  ShaderId id;
  std::string_view name;
  std::string_view vertex_path;
  /** Empty: none. */
  std::string_view geometry_path;
  std::string_view fragment_path;
  /** The features that the program has variants for. Others make no difference to it. */
  Feature features;
  /** The subset of `features` that all variants have. */
  Feature required;
  /** Why it exists. */
  std::string_view purpose;
  /** "NAME value" or "NAME", defined in each variant; empty: none. */
  std::string_view define{};
};

/** The define of a feature. */
struct FeatureDefine {
  Feature feature;
  const char *define;
  /** The condition under which a scene needs it. */
  std::string_view purpose;
};

/** One entry for each Feature, from the lowest bit. */
[[nodiscard]] std::span<const FeatureDefine> feature_defines();

/** One entry for each ShaderId, in order. */
[[nodiscard]] std::span<const ShaderDeclaration> shader_declarations();

/** The variants of \a declaration that a scene can need. Impossible and equivalent masks are left out. */
[[nodiscard]] std::vector<Feature> shader_variants(const ShaderDeclaration &declaration);

/** One variant, ready for gpu::Device::create_shader. \a pcf matters with Feature::ShadowPcf only. */
[[nodiscard]] gpu::ShaderDesc shader_desc(const ShaderDeclaration &declaration, Feature features,
                                          const PcfKernel &pcf = {});

}  // namespace gnomon::eevee
