// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_features.hh"

#include "gpu_device.hh"
#include "shader_files.hh"

#include <map>
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

/** A program of the engine as data: what the engine, the checker and the tests read. */
struct ShaderDeclaration {
  ShaderId id;
  std::string_view name;
  std::string_view vertex_path;
  /** Empty: none. */
  std::string_view geometry_path;
  std::string_view fragment_path;
  /** The features it has variants for; others make no difference to it. */
  Feature features;
  /** Of these, those that it always has. */
  Feature required;
  /** Why it exists. */
  std::string_view purpose;
  /** "NAME value" or "NAME", defined in each variant; empty: none. */
  std::string_view define{};
};

/** A feature as the shaders see it. */
struct FeatureDefine {
  Feature feature;
  const char *define;
  /** When a scene asks for it. */
  std::string_view purpose;
};

/** All of them, one a Feature, from the lowest bit. */
[[nodiscard]] std::span<const FeatureDefine> feature_defines();

/** All of them, one a ShaderId, in order. */
[[nodiscard]] std::span<const ShaderDeclaration> shader_declarations();

/** The variants of \a declaration that a scene can ask for: impossible and equivalent masks are left out. */
[[nodiscard]] std::vector<Feature> shader_variants(const ShaderDeclaration &declaration);

/** One variant, ready for gpu::Device::create_shader. \a pcf: of Feature::ShadowPcf. */
[[nodiscard]] gpu::ShaderDesc shader_desc(const ShaderDeclaration &declaration, Feature features,
                                          const PcfKernel &pcf = {});

/** Programs made when first asked for, and kept. Must go before its device. */
class ShaderCache {
 public:
  /** Programs of another kernel are forgotten. */
  void set_pcf(const PcfKernel &pcf);
  /** Features that the program has no variant for are ignored. \throws gpu::Error where it does not compile. */
  const gpu::Shader &get(gpu::Device &device, ShaderId id, Feature features = Feature::None);
  /**
   * Compile all that were made again, from \a files, and from now on. A program that does not compile stays as it was.
   * Passes recorded before must be recorded again.
   *
   * \return why, of each program that stayed: file, line and reason.
   */
  std::vector<std::string> reload(gpu::Device &device, gpu::ShaderFiles files);
  [[nodiscard]] std::size_t size() const
  {
    return shaders_.size();
  }
  /** Variants of a program that were made, each with its features. */
  [[nodiscard]] std::vector<Feature> made(ShaderId id) const;

 private:
  /** Those that the program was built with, until reload gives others. */
  gpu::ShaderFiles files_ = shaders::file;
  PcfKernel pcf_;
  std::map<std::pair<ShaderId, Feature>, gpu::Shader> shaders_;
};

}  // namespace gnomon::eevee
