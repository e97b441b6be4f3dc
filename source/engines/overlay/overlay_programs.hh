// SPDX-License-Identifier: MIT
// The programs as data. The build generates their interfaces from it, so that this header may use no other header of
// the folder.
#pragma once

#include "gpu_shader.hh"
#include "gpu_state.hh"

#include <span>

namespace gnomon::overlay {

enum class ShaderId { Objects, Outline, Lines };

/** The features for which programs have variants. */
enum class Feature : std::uint32_t {
  None = 0,
  AlphaMask = 1U << 0,
  /** The mask reads more than the base colour texture; with AlphaMask alone. */
  FullMaterial = 1U << 1,
  /** Objects hide lines. */
  HiddenLines = 1U << 2,
  /** The view has clip planes. */
  ClipPlanes = 1U << 3,
};

GNOMON_MASK_OPERATORS(Feature)

/** One program. */
struct ShaderDeclaration {
  ShaderId id;
  std::string_view name;
  std::string_view vertex_path;
  std::string_view fragment_path;
  /** The variants that a scene can need. */
  std::span<const Feature> variants;
  /** Why it exists. */
  std::string_view purpose;
};

/** One entry for each ShaderId, in order. */
[[nodiscard]] std::span<const ShaderDeclaration> shader_declarations();
[[nodiscard]] inline std::span<const Feature> shader_variants(const ShaderDeclaration &declaration)
{
  return declaration.variants;
}
/** One variant, ready for gpu::Device::create_shader. */
[[nodiscard]] gpu::ShaderDesc shader_desc(const ShaderDeclaration &declaration, Feature features);

}  // namespace gnomon::overlay
