// SPDX-License-Identifier: MIT
#include "gpu_shader.hh"

#include "gpu_error.hh"

#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>

#include <algorithm>
#include <memory>
#include <tuple>

namespace gnomon::gpu {

namespace {

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
  static const Process PROCESS;
}

EShLanguage language(ShaderStage stage)
{
  switch (stage) {
    case ShaderStage::Vertex: return EShLangVertex;
    case ShaderStage::Geometry: return EShLangGeometry;
    case ShaderStage::Fragment: return EShLangFragment;
  }
  return EShLangVertex;
}

ShaderInterface interface_of(glslang::TProgram &program)
{
  ShaderInterface interface;
  int push_constant_block = -1;
  for (int i = 0; i < program.getNumUniformBlocks(); i++) {
    const glslang::TObjectReflection &block = program.getUniformBlock(i);
    if (block.name == PUSH_CONSTANT_BLOCK) {
      push_constant_block = i;
      interface.push_constant_slot = block.getBinding();
      interface.push_constant_size_bytes = std::uint32_t(block.size);
      continue;
    }
    interface.bindings.push_back({block.name, BindingKind::UniformBlock, block.getBinding(), std::uint32_t(block.size)});
  }
  for (int i = 0; i < program.getNumBufferBlocks(); i++) {
    const glslang::TObjectReflection &block = program.getBufferBlock(i);
    interface.bindings.push_back({block.name, BindingKind::StorageBlock, block.getBinding(), std::uint32_t(block.size)});
  }
  for (int i = 0; i < program.getNumUniformVariables(); i++) {
    const glslang::TObjectReflection &uniform = program.getUniform(i);
    if (uniform.index == -1 && uniform.getBinding() >= 0) {
      interface.bindings.push_back({uniform.name, BindingKind::Texture, uniform.getBinding(), 0});
    }
    else if (uniform.index >= 0 && uniform.index == push_constant_block) {
      // The instance's name stands before the member's.
      const std::string name = uniform.name.substr(uniform.name.rfind('.') + 1);
      interface.push_constant_members.push_back({name, std::uint32_t(uniform.offset), 0});
    }
  }
  std::ranges::sort(interface.push_constant_members, {}, &ShaderInterface::Member::offset_bytes);
  for (std::size_t i = 0; i < interface.push_constant_members.size(); i++) {
    const bool is_last = i + 1 == interface.push_constant_members.size();
    const std::uint32_t end =
        is_last ? interface.push_constant_size_bytes : interface.push_constant_members[i + 1].offset_bytes;
    interface.push_constant_members[i].size_bytes = end - interface.push_constant_members[i].offset_bytes;
  }
  std::ranges::sort(interface.bindings, [](const auto &a, const auto &b) {
    return std::tie(a.kind, a.slot, a.name) < std::tie(b.kind, b.slot, b.name);
  });
  return interface;
}

void check_slots(std::string_view name, const ShaderInterface &interface)
{
  for (std::size_t i = 1; i < interface.bindings.size(); i++) {
    const ShaderInterface::Binding &a = interface.bindings[i - 1];
    const ShaderInterface::Binding &b = interface.bindings[i];
    if (a.kind == b.kind && a.slot == b.slot) {
      throw Error("shader '{}': {} '{}' and '{}' share slot {}", name, to_string(a.kind), a.name, b.name, a.slot);
    }
  }
}

}  // namespace

ShaderInterface reflect(std::string_view name, const std::vector<ShaderSource> &stages)
{
  initialize_glslang();
  constexpr int GLSL_VERSION = 450;
  constexpr EShMessages MESSAGES = EShMsgDefault;
  std::vector<std::unique_ptr<glslang::TShader>> shaders;
  glslang::TProgram program;
  for (const ShaderSource &stage : stages) {
    auto &shader = *shaders.emplace_back(std::make_unique<glslang::TShader>(language(stage.stage)));
    const char *text = stage.text.c_str();
    shader.setStrings(&text, 1);
    shader.setEnvInput(glslang::EShSourceGlsl, language(stage.stage), glslang::EShClientOpenGL, GLSL_VERSION);
    shader.setEnvClient(glslang::EShClientOpenGL, glslang::EShTargetOpenGL_450);
    if (!shader.parse(GetDefaultResources(), GLSL_VERSION, false, MESSAGES)) {
      throw Error("shader '{}', {} stage:\n{}", name, to_string(stage.stage), stage.name_files(shader.getInfoLog()));
    }
    program.addShader(&shader);
  }
  if (!program.link(MESSAGES)) {
    throw Error("shader '{}' does not link:\n{}", name, program.getInfoLog());
  }
  program.buildReflection(EShReflectionSeparateBuffers | EShReflectionAllBlockVariables);
  ShaderInterface interface = interface_of(program);
  check_slots(name, interface);
  return interface;
}

}  // namespace gnomon::gpu
