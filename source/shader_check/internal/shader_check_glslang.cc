// SPDX-License-Identifier: MIT
#include "shader_check_glslang.hh"

#include <glslang/Public/ResourceLimits.h>

#include <pthread.h>
#include <exception>

namespace gnomon::shader_check {

namespace {

constexpr int glsl_version = 450;
constexpr EShMessages messages = EShMsgDefault;

/** Creates glslang's process-wide tables at the first use, because that takes some milliseconds. */
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

/** Reserved address space; the system commits only the pages in use. */
constexpr std::size_t stack_bytes = std::size_t(512) << 20U;
/** An expression has at most one operator for each two bytes, and an operator takes less than 1 KiB of stack. */
constexpr std::size_t source_bytes_max = stack_bytes / 512;

struct StackedWork {
  const std::function<void()> &work;
  std::exception_ptr failure;
};

void *run_stacked(void *argument)
{
  auto *stacked = static_cast<StackedWork *>(argument);
  try {
    stacked->work();
  }
  catch (...) {
    stacked->failure = std::current_exception();
  }
  return nullptr;
}

}  // namespace

void with_large_stack(const std::function<void()> &work)
{
  StackedWork stacked{work, nullptr};
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, stack_bytes);
  pthread_t thread{};
  const int failed = pthread_create(&thread, &attributes, run_stacked, &stacked);
  pthread_attr_destroy(&attributes);
  if (failed != 0) {
    throw gpu::Error("checking shaders: no thread with a stack of {} MiB can be made", stack_bytes >> 20U);
  }
  pthread_join(thread, nullptr);
  if (stacked.failure) {
    std::rethrow_exception(stacked.failure);
  }
}

EShLanguage glslang_language(gpu::ShaderStage stage)
{
  switch (stage) {
    case gpu::ShaderStage::Vertex: return EShLangVertex;
    case gpu::ShaderStage::Geometry: return EShLangGeometry;
    case gpu::ShaderStage::Fragment: return EShLangFragment;
  }
  return EShLangVertex;
}

GlslangProgram::GlslangProgram()
{
  initialize_glslang();
  program_ = std::make_unique<glslang::TProgram>();
}

bool GlslangProgram::add(const gpu::ShaderSource &source, GlslangTarget target)
{
  if (source.text.size() > source_bytes_max) {
    log_ = fmt::format("ERROR: 0:1: the stage takes {} bytes with its includes, and at most {} are checked\n",
                       source.text.size(), source_bytes_max);
    return false;
  }
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

}  // namespace gnomon::shader_check
