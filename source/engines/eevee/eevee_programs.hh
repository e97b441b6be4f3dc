// SPDX-License-Identifier: MIT
// Declarations of the engine's shader programs. The build generates the interfaces of the programs from these
// declarations (../interface_tool/). For this reason the header may include only eevee_features.hh of the engine.
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
  Surfaces,
  DepthFunction,
  GBuffer,
  DeferredLit,
  AdaptiveTest,
  AdaptiveSpread,
  AdaptiveDepth,
  AdaptiveScale,
};

/** Declaration of a shader program. The engine, the build, the shader checks and the tests read it. */
struct ShaderDeclaration {
  ShaderId id;
  std::string_view name;
  std::string_view vertex_path;
  /** Empty if the program has no geometry shader. */
  std::string_view geometry_path;
  std::string_view fragment_path;
  /** The features for which the program has variants. Other features do not change the program. */
  Feature features;
  /** The subset of `features` that is set in all variants. */
  Feature required;
  /** The purpose of the program, for reports. */
  std::string_view purpose;
  /** A define of all variants, as "NAME value" or "NAME". Empty if there is none. */
  std::string_view define{};
};

/** The preprocessor define of a feature. */
struct FeatureDefine {
  Feature feature;
  const char *define;
  /** The condition under which a scene needs the feature, for reports. */
  std::string_view purpose;
};

/** One entry for each Feature, from the lowest bit. */
[[nodiscard]] std::span<const FeatureDefine> feature_defines();

/** One entry for each ShaderId, in order. */
[[nodiscard]] std::span<const ShaderDeclaration> shader_declarations();

/**
 * The features of a frame, extended to a mask for which programs have a variant. \a features: those of its lamps, its
 * world and its materials. Feature::Multiscatter is removed if nothing reflects specularly.
 */
[[nodiscard]] Feature with_variant(Feature features);

/** The mask of shader_variants that \a features, a result of with_variant, select for the program. */
[[nodiscard]] Feature variant_of(const ShaderDeclaration &declaration, Feature features);

/** The program_constants that \a variant, one of shader_variants, can have. */
[[nodiscard]] Feature constants_of(const ShaderDeclaration &declaration, Feature variant);

/** The feature masks of \a declaration that a scene can need, without impossible masks and without duplicates. */
[[nodiscard]] std::vector<Feature> shader_variants(const ShaderDeclaration &declaration);

/**
 * The feature masks of \a declaration with which a program may contain a surface function; empty: it never does. All
 * are shader_variants(). Each function makes those programs again that materials with it are drawn with.
 */
[[nodiscard]] std::vector<Feature> surface_function_variants(const ShaderDeclaration &declaration);
/** Where programs include the text of the surface function. */
inline constexpr std::string_view surface_function_file = "user/surface.glsl";
/** \a desc of a variant of \a declaration, with the surface function in it. */
[[nodiscard]] gpu::ShaderDesc with_surface_function(gpu::ShaderDesc desc, const ShaderDeclaration &declaration);
/** A line of a surface function that no program may contain. */
struct SurfaceFunctionFault {
  /** From 1. */
  int line;
  std::string reason;
};
/** The first directive in \a text that a surface function may not have: it is part of a file with a version. */
[[nodiscard]] std::optional<SurfaceFunctionFault> surface_function_fault(std::string_view text);

/**
 * The description of one variant for gpu::Device::create_shader. \a pcf is used only with Feature::ShadowPcf. \a
 * features may contain program_constants.
 */
[[nodiscard]] gpu::ShaderDesc shader_desc(const ShaderDeclaration &declaration, Feature features,
                                          const PcfKernel &pcf = {});

}  // namespace gnomon::eevee
