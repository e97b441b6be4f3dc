// SPDX-License-Identifier: MIT
// glslang, for reflection and for checks.
#pragma once

#include "gpu_shader.hh"

#include <glslang/Public/ShaderLang.h>

#include <functional>
#include <memory>

namespace gnomon::shader_check {

enum class GlslangTarget : std::uint8_t {
  /** GLSL as a driver reads it: what glShaderSource takes. */
  OpenGl,
  /** SPIR-V 1.0 for OpenGL 4.5. */
  OpenGlSpirv,
  /** SPIR-V 1.5 for Vulkan 1.2. */
  VulkanSpirv,
};

/**
 * Run \a work on a thread with a stack of 512 MiB and wait for it. glslang recurses once per operator of an expression:
 * one of 100 000 operators overflows a usual stack of 8 MiB. The large stack suffices for 1 MiB of text; macros that
 * multiply a short text to millions of operators overflow it, too.
 *
 * \throws what \a work throws; Error if there is no memory for the thread.
 */
void with_large_stack(const std::function<void()> &work);

[[nodiscard]] EShLanguage glslang_language(gpu::ShaderStage stage);

/** The stages of one shader. Several threads may each have programs. Call it within with_large_stack only. */
class GlslangProgram {
 public:
  GlslangProgram();

  /** Compile \a source, which must outlive this. False: log() has the reason. A source of more than 1 MiB is refused.
   */
  bool add(const gpu::ShaderSource &source, GlslangTarget target);
  /** Call it after all stages are added. False: log() has the reason. */
  bool link();
  /** Of the last call. */
  [[nodiscard]] std::string_view log() const
  {
    return log_;
  }
  [[nodiscard]] glslang::TProgram &program()
  {
    return *program_;
  }

 private:
  std::vector<std::unique_ptr<glslang::TShader>> shaders_;
  /** Declared behind the shaders, because it refers to them until it is destroyed. */
  std::unique_ptr<glslang::TProgram> program_;
  std::string log_;
};

/** The interface of a linked program. */
[[nodiscard]] gpu::ShaderInterface interface_of(glslang::TProgram &program);

}  // namespace gnomon::shader_check
