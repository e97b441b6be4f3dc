// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_programs.hh"

#include "gpu_device.hh"

#include <map>

namespace gnomon::eevee {

/** Programs, made when first used and then kept. Destroy it before its device. */
class ShaderCache {
 public:
  /** The shader files and interfaces that the build put into the library. */
  ShaderCache();

  /** Programs of another kernel are destroyed. */
  void set_pcf(const PcfKernel &pcf);
  /** Features that the program has no variant for are ignored. \throws gpu::Error if it does not compile. */
  const gpu::Shader &get(gpu::Device &device, ShaderId id, Feature features = Feature::None);
  /**
   * Compile all programs again, from \a files; later ones, too, are made from these. \a reflection returns their
   * interfaces: shader_check::reflect, from a library that hosts link only for this. If it is empty, nothing changes
   * and the result says so. A program that does not compile stays as it was. Record passes again that were recorded
   * before.
   *
   * \return one message with file, line and reason for each program that does not compile; empty: all do.
   */
  std::vector<std::string> reload(gpu::Device &device, gpu::ShaderFiles files, gpu::ShaderReflection reflection);
  [[nodiscard]] std::size_t size() const
  {
    return shaders_.size();
  }
  /** The features of each variant of a program that was made. */
  [[nodiscard]] std::vector<Feature> made(ShaderId id) const;

 private:
  using Key = std::pair<ShaderId, Feature>;

  [[nodiscard]] gpu::Shader make(gpu::Device &device, const Key &key) const;

  gpu::ShaderFiles files_;
  /** Empty until reload(): the generated table serves. */
  gpu::ShaderReflection reflection_;
  PcfKernel pcf_;
  std::map<Key, gpu::Shader> shaders_;
};

}  // namespace gnomon::eevee
