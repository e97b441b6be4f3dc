// SPDX-License-Identifier: MIT
#pragma once

#include "eevee_programs.hh"

#include "gpu_device.hh"

#include <map>
#include <memory>
#include <set>
#include <string>
#include <tuple>

namespace gnomon::eevee {

/** The surface function that a program contains. \see scene::SurfaceFunction */
struct FunctionText {
  /** Differs for all texts that a cache is used with; 0: no function. */
  std::uint64_t key = 0;
  std::string_view text{};
  /** Name of the file, for messages. */
  std::string_view file{};
};

/**
 * The engine's programs. The first use of a program compiles it, unless the device has it from another engine. Must be
 * destroyed before its device.
 */
class ShaderCache {
 public:
  /** Uses the shader files and interfaces that the build embedded in the library. */
  ShaderCache();

  /** Set the kernel of percentage-closer filtering. Lets programs with another kernel go. */
  void set_pcf(const PcfKernel &pcf);
  /**
   * The program \a id with \a features. Features without a variant of the program are ignored. If the program with
   * \a function does not compile, it is made with a stand-in (eevee_surface_stand_in.glsl). \pre \a function is in no
   * program, or \a features are one of surface_function_variants()
   * \throws gpu::Error if the program does not compile.
   */
  const gpu::Shader &get(gpu::Device &device, ShaderId id, Feature features = Feature::None,
                         const FunctionText &function = {});
  /** Lets the programs of all functions go but those with these keys. */
  void keep_functions(const std::set<std::uint64_t> &keys);
  /** Takes note of the programs of functions that did not compile when the packet was submitted. */
  void take_failures(const gpu::Feedback &feedback);
  /** The reason why the stand-in is drawn instead of a function, with file and line; empty: there is none. */
  [[nodiscard]] std::string failure(std::uint64_t function_key) const;
  /**
   * Compile all programs again from \a files, and use \a files for programs that are compiled later. \a reflection
   * returns the interfaces of programs, for example shader_check::reflect from the library gnomon::shader_check. If it
   * is empty, nothing changes and the result contains a message about it. A program that does not compile keeps its
   * last state. Other engines keep theirs. After a reload, all passes must be recorded again.
   *
   * \return one message with file, line and reason for each program that does not compile.
   */
  std::vector<std::string> reload(gpu::Device &device, gpu::ShaderFiles files, gpu::ShaderReflection reflection);
  /** Increased by reload(). */
  [[nodiscard]] std::uint64_t revision() const
  {
    return revision_;
  }
  [[nodiscard]] std::size_t size() const
  {
    return shaders_.size();
  }
  /** The feature masks of all variants of a program that were created, with and without surface functions. */
  [[nodiscard]] std::vector<Feature> made(ShaderId id) const;

 private:
  /** The last element is the key of the surface function. */
  using Key = std::tuple<ShaderId, Feature, std::uint64_t>;
  struct Function {
    std::string text;
    std::string file;
  };

  [[nodiscard]] std::shared_ptr<gpu::SharedShader> make(gpu::Device &device, const Key &key) const;
  [[nodiscard]] gpu::SharedShader make_with(std::uint64_t function_key, gpu::Device &device,
                                            const gpu::ShaderDesc &desc, const gpu::ShaderReflection &reflection) const;

  gpu::ShaderFiles files_;
  /** Empty before reload(); until then the interfaces come from the generated tables. */
  gpu::ShaderReflection reflection_;
  PcfKernel pcf_;
  std::uint64_t revision_ = 0;
  std::map<Key, std::shared_ptr<gpu::SharedShader>> shaders_;
  std::map<std::uint64_t, Function> functions_;
};

}  // namespace gnomon::eevee
