// SPDX-License-Identifier: MIT
// The engine's programs as data. The build generates their interfaces from it, so that this header may use no other
// header of the engine.
#pragma once

#include "gpu_shader.hh"

#include <span>

namespace gnomon::unlit {

enum class ShaderId { Depth, Surface, Target };

/** What programs have variants for. */
enum class Feature : std::uint32_t {
  None = 0,
  BaseColorTexture = 1U << 0,
  FullMaterial = 1U << 1,
  AlphaMask = 1U << 2,
  DepthCamera = 1U << 3,
  TargetDepth = 1U << 4,
};

constexpr Feature operator|(Feature a, Feature b)
{
  return Feature(std::uint32_t(a) | std::uint32_t(b));
}
constexpr Feature operator&(Feature a, Feature b)
{
  return Feature(std::uint32_t(a) & std::uint32_t(b));
}
constexpr bool has(Feature mask, Feature any)
{
  return (mask & any) != Feature::None;
}

/** One program. */
struct ShaderDeclaration {
  ShaderId id;
  std::string_view name;
  std::string_view vertex_path;
  std::string_view fragment_path;
  /** The features that the program has variants for. */
  Feature features;
  /** Why it exists. */
  std::string_view purpose;
};

/** One entry for each ShaderId, in order. */
[[nodiscard]] std::span<const ShaderDeclaration> shader_declarations();
/** The variants of \a declaration that a scene can need. */
[[nodiscard]] std::vector<Feature> shader_variants(const ShaderDeclaration &declaration);
/** One variant, ready for gpu::Device::create_shader. */
[[nodiscard]] gpu::ShaderDesc shader_desc(const ShaderDeclaration &declaration, Feature features);

}  // namespace gnomon::unlit
