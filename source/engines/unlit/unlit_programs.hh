// SPDX-License-Identifier: MIT
// Declarations of the engine's shader programs. The build generates the interfaces of the programs from these
// declarations. For this reason the header must not include other headers of the engine.
#pragma once

#include "gpu_shader.hh"
#include "gpu_state.hh"

#include <span>

namespace gnomon::unlit {

enum class ShaderId { Depth, Surface, Target };

/** Features for which programs have variants. */
enum class Feature : std::uint32_t {
  None = 0,
  BaseColorTexture = 1U << 0,
  FullMaterial = 1U << 1,
  AlphaMask = 1U << 2,
  DepthCamera = 1U << 3,
  TargetDepth = 1U << 4,
  /** The view has clip planes. */
  ClipPlanes = 1U << 5,
  /** Display::is_xray. */
  XRay = 1U << 6,
};

GNOMON_MASK_OPERATORS(Feature)

/** Declaration of a shader program. */
struct ShaderDeclaration {
  ShaderId id;
  std::string_view name;
  std::string_view vertex_path;
  std::string_view fragment_path;
  /** The features for which the program has variants. */
  Feature features;
  /** The purpose of the program, for reports. */
  std::string_view purpose;
};

/** One entry for each ShaderId, in order. */
[[nodiscard]] std::span<const ShaderDeclaration> shader_declarations();
/** The feature masks of \a declaration that a scene can need. */
[[nodiscard]] std::vector<Feature> shader_variants(const ShaderDeclaration &declaration);
/** The description of one variant for gpu::Device::create_shader. */
[[nodiscard]] gpu::ShaderDesc shader_desc(const ShaderDeclaration &declaration, Feature features);

}  // namespace gnomon::unlit
