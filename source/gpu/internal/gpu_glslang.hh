// SPDX-License-Identifier: MIT
// glslang, for reflection and for checks.
#pragma once

#include "gpu_shader.hh"

#include <glslang/Public/ShaderLang.h>

#include <memory>

namespace gnomon::gpu {

enum class GlslangTarget : std::uint8_t {
  /** GLSL as a driver reads it: what glShaderSource takes. */
  OpenGl,
  /** SPIR-V 1.0 for OpenGL 4.5. */
  OpenGlSpirv,
  /** SPIR-V 1.5 for Vulkan 1.2. */
  VulkanSpirv,
};

[[nodiscard]] EShLanguage glslang_language(ShaderStage stage);

/** The stages of one shader. Programs are independent of each other: each thread may have some. */
class GlslangProgram {
 public:
  GlslangProgram();

  /** Compile \a source, which must stay. False: log() says why. */
  bool add(const ShaderSource &source, GlslangTarget target);
  /** After all stages were added. False: log() says why. */
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
  /** Goes before the shaders that it refers to. */
  std::unique_ptr<glslang::TProgram> program_;
  std::string log_;
};

/** What a linked program reads. */
[[nodiscard]] ShaderInterface interface_of(glslang::TProgram &program);

}  // namespace gnomon::gpu
