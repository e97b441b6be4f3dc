// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_programs.hh"

#include "gpu_device.hh"

#include <map>

namespace gnomon::eevee {

/** Cache of the engine's programs. The first use of a program compiles it. Must be destroyed before its device. */
class ShaderCache {
 public:
  /** Uses the shader files and interfaces that the build embedded in the library. */
  ShaderCache();

  /** Set the kernel of percentage-closer filtering. Destroys programs with another kernel. */
  void set_pcf(const PcfKernel &pcf);
  /**
   * The program \a id with \a features. Features without a variant of the program are ignored.
   * \throws gpu::Error if the program does not compile.
   */
  const gpu::Shader &get(gpu::Device &device, ShaderId id, Feature features = Feature::None);
  /**
   * Compile all programs again from \a files, and use \a files for programs that are compiled later. \a reflection
   * returns the interfaces of programs, for example shader_check::reflect from the library gnomon::shader_check. If it
   * is empty, nothing changes and the result contains a message about it. A program that does not compile keeps its
   * last state. After a reload, all passes must be recorded again.
   *
   * \return one message with file, line and reason for each program that does not compile.
   */
  std::vector<std::string> reload(gpu::Device &device, gpu::ShaderFiles files, gpu::ShaderReflection reflection);
  [[nodiscard]] std::size_t size() const
  {
    return shaders_.size();
  }
  /** The feature masks of all variants of a program that were created. */
  [[nodiscard]] std::vector<Feature> made(ShaderId id) const;

 private:
  using Key = std::pair<ShaderId, Feature>;

  [[nodiscard]] gpu::Shader make(gpu::Device &device, const Key &key) const;

  gpu::ShaderFiles files_;
  /** Empty before reload(); until then the interfaces come from the generated tables. */
  gpu::ShaderReflection reflection_;
  PcfKernel pcf_;
  std::map<Key, gpu::Shader> shaders_;
};

}  // namespace gnomon::eevee
