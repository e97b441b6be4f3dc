// SPDX-License-Identifier: MIT
#include "gpu_glslang.hh"

#include <glslang/Public/ResourceLimits.h>

namespace gnomon::gpu {

namespace {

constexpr int glsl_version = 450;
constexpr EShMessages messages = EShMsgDefault;

/** glslang's process-wide tables; made at the first use, as they take a moment. */
void initialize_glslang()
{
  struct Process {
    Process()
    {
      glslang::InitializeProcess();
    }
    ~Process()
    {
      glslang::FinalizeProcess();
    }
  };
  static const Process process;
}

}  // namespace

EShLanguage glslang_language(ShaderStage stage)
{
  switch (stage) {
    case ShaderStage::Vertex: return EShLangVertex;
    case ShaderStage::Geometry: return EShLangGeometry;
    case ShaderStage::Fragment: return EShLangFragment;
  }
  return EShLangVertex;
}

GlslangProgram::GlslangProgram()
{
  initialize_glslang();
  program_ = std::make_unique<glslang::TProgram>();
}

bool GlslangProgram::add(const ShaderSource &source, GlslangTarget target)
{
  const EShLanguage language = glslang_language(source.stage);
  glslang::TShader &shader = *shaders_.emplace_back(std::make_unique<glslang::TShader>(language));
  const char *text = source.text.c_str();
  shader.setStrings(&text, 1);
  if (target == GlslangTarget::VulkanSpirv) {
    constexpr int vulkan_dialect = 100;
    shader.setEnvInput(glslang::EShSourceGlsl, language, glslang::EShClientVulkan, vulkan_dialect);
    shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_2);
    shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_5);
  }
  else {
    constexpr int opengl_dialect = 100;
    const bool is_spirv = target == GlslangTarget::OpenGlSpirv;
    shader.setEnvInput(glslang::EShSourceGlsl, language, glslang::EShClientOpenGL,
                       is_spirv ? opengl_dialect : glsl_version);
    shader.setEnvClient(glslang::EShClientOpenGL, glslang::EShTargetOpenGL_450);
    if (is_spirv) {
      shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_0);
    }
  }
  const bool is_done = shader.parse(GetDefaultResources(), glsl_version, false, messages);
  log_ = shader.getInfoLog();
  program_->addShader(&shader);
  return is_done;
}

bool GlslangProgram::link()
{
  const bool is_done = program_->link(messages);
  log_ = program_->getInfoLog();
  return is_done;
}

}  // namespace gnomon::gpu
