// SPDX-License-Identifier: MIT
#include "shader_check_glslang.hh"

#include <glslang/Public/ResourceLimits.h>
#include <glslang/build_info.h>

#include <pthread.h>
#include <exception>

namespace gnomon::shader_check {

namespace {

EShMessages messages_for(StageErrors errors)
{
  unsigned messages = errors == StageErrors::All ? EShMsgDefault | EShMsgCascadingErrors : EShMsgDefault;
  // glslang prints columns from version 15 on.
#if GLSLANG_VERSION_GREATER_OR_EQUAL_TO(15, 0, 0)
  messages |= EShMsgDisplayErrorColumn;
#endif
  return EShMessages(messages);
}

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
// An expression has at most one operator for each two bytes, and an operator takes less than 1 KiB of stack.
static_assert(stage_bytes_max <= stack_bytes / 512);

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

EShLanguage glslang_language(Stage stage)
{
  switch (stage) {
    case Stage::Vertex: return EShLangVertex;
    case Stage::TessControl: return EShLangTessControl;
    case Stage::TessEvaluation: return EShLangTessEvaluation;
    case Stage::Geometry: return EShLangGeometry;
    case Stage::Task: return EShLangTask;
    case Stage::Mesh: return EShLangMesh;
    case Stage::Fragment: return EShLangFragment;
    case Stage::Compute: return EShLangCompute;
    case Stage::RayGeneration: return EShLangRayGen;
    case Stage::Intersection: return EShLangIntersect;
    case Stage::AnyHit: return EShLangAnyHit;
    case Stage::ClosestHit: return EShLangClosestHit;
    case Stage::Miss: return EShLangMiss;
    case Stage::Callable: return EShLangCallable;
  }
  return EShLangVertex;
}

GlslangProgram::GlslangProgram(StageErrors errors) : messages_(messages_for(errors))
{
  initialize_glslang();
  program_ = std::make_unique<glslang::TProgram>();
}

namespace {

/** Sets the dialect of \a shader. \return the version of a text without `#version` */
int set_target(glslang::TShader &shader, EShLanguage language, CheckTarget target)
{
  // The version of GL_KHR_vulkan_glsl and GL_ARB_gl_spirv.
  constexpr int dialect = 100;
  constexpr int desktop_version = 110;
  constexpr int es_version = 100;
  const auto set_vulkan = [&](glslang::EShTargetClientVersion client, glslang::EShTargetLanguageVersion spirv) {
    shader.setEnvInput(glslang::EShSourceGlsl, language, glslang::EShClientVulkan, dialect);
    shader.setEnvClient(glslang::EShClientVulkan, client);
    shader.setEnvTarget(glslang::EShTargetSpv, spirv);
  };
  switch (target) {
    case CheckTarget::OpenGl: break;
    case CheckTarget::OpenGlSpirv:
      shader.setEnvInput(glslang::EShSourceGlsl, language, glslang::EShClientOpenGL, dialect);
      shader.setEnvClient(glslang::EShClientOpenGL, glslang::EShTargetOpenGL_450);
      shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_0);
      break;
    case CheckTarget::Es: return es_version;
    case CheckTarget::Vulkan10: set_vulkan(glslang::EShTargetVulkan_1_0, glslang::EShTargetSpv_1_0); break;
    case CheckTarget::Vulkan11: set_vulkan(glslang::EShTargetVulkan_1_1, glslang::EShTargetSpv_1_3); break;
    case CheckTarget::Vulkan12: set_vulkan(glslang::EShTargetVulkan_1_2, glslang::EShTargetSpv_1_5); break;
    case CheckTarget::Vulkan13: set_vulkan(glslang::EShTargetVulkan_1_3, glslang::EShTargetSpv_1_6); break;
  }
  return desktop_version;
}

/** Gives \a shader the text of \a source and returns what \a read does with the version and the includer. */
template <typename Read>
bool read_source(glslang::TShader &shader, StageSource &source, CheckTarget target, Read &&read)
{
  const char *text = source.text().c_str();
  const int length = int(source.text().size());
  const char *name = source.name().empty() ? nullptr : source.name().c_str();
  shader.setStringsWithLengthsAndNames(&text, &length, &name, 1);
  shader.setPreamble(source.preamble().c_str());
  const int version = set_target(shader, glslang_language(source.stage()), target);
  glslang::TShader::ForbidIncluder none;
  glslang::TShader::Includer *includer = source.start_includer();
  return read(version, includer == nullptr ? none : *includer);
}

}  // namespace

bool GlslangProgram::add(StageSource &source, CheckTarget target, bool needs_slots)
{
  if (source.text().size() > stage_bytes_max) {
    log_ = fmt::format("ERROR: {}:1: {}\n", source.name().empty() ? "0" : source.name(), too_long_text());
    return false;
  }
  glslang::TShader &shader =
      *shaders_.emplace_back(std::make_unique<glslang::TShader>(glslang_language(source.stage())));
  // glslang maps nothing without a call of mapIO().
  shader.setAutoMapBindings(!needs_slots);
  shader.setAutoMapLocations(!needs_slots);
  const bool is_done = read_source(shader, source, target, [&](int version, glslang::TShader::Includer &includer) {
    return shader.parse(GetDefaultResources(), version, false, messages_, includer);
  });
  log_ = shader.getInfoLog();
  program_->addShader(&shader);
  return is_done;
}

std::string GlslangProgram::preprocessed(StageSource &source, CheckTarget target)
{
  glslang::TShader shader(glslang_language(source.stage()));
  std::string text;
  read_source(shader, source, target, [&](int version, glslang::TShader::Includer &includer) {
    return shader.preprocess(GetDefaultResources(), version, ENoProfile, false, false, messages_, &text, includer);
  });
  return text;
}

bool GlslangProgram::link()
{
  const bool is_done = program_->link(messages_);
  log_ = program_->getInfoLog();
  return is_done;
}

}  // namespace gnomon::shader_check
