// SPDX-License-Identifier: MIT
#include "shader_check_spirv.hh"

#include "internal/shader_check_glslang.hh"
#include "internal/shader_check_log.hh"

#include <glslang/SPIRV/GlslangToSpv.h>
#include <spirv-tools/optimizer.hpp>

#include <memory>

namespace gnomon::shader_check {

namespace {

/** Smaller code that means the same. Drivers on the CPU make a large pipeline from it in less than half of the time. */
void optimise(std::string_view name, std::vector<std::uint32_t> &words)
{
  spvtools::Optimizer optimizer(SPV_ENV_VULKAN_1_2);
  std::string reason;
  optimizer.SetMessageConsumer(
      [&](spv_message_level_t, const char *, const spv_position_t &, const char *text) { reason += text; });
  optimizer.RegisterPerformancePasses();
  std::vector<std::uint32_t> optimised;
  if (!optimizer.Run(words.data(), words.size(), &optimised)) {
    throw gpu::Error("shader '{}': SPIR-V: {}", name, reason);
  }
  words = std::move(optimised);
}

}  // namespace

std::vector<gpu::SpirvStage> compile_spirv(std::string_view name, const std::vector<gpu::ShaderSource> &stages)
{
  std::vector<gpu::SpirvStage> compiled;
  with_large_stack([&] {
    // The program refers to the sources until it is destroyed.
    std::vector<std::unique_ptr<StageSource>> sources;
    GlslangProgram glslang;
    for (const gpu::ShaderSource &stage : stages) {
      if (!glslang.add(*sources.emplace_back(std::make_unique<StageSource>(stage)), CheckTarget::Vulkan12)) {
        throw gpu::Error("shader '{}', {} stage:\n{}", name, to_string(stage.stage),
                         bounded_lines(stage.name_files(glslang.log())));
      }
    }
    if (!glslang.link()) {
      throw gpu::Error("shader '{}' does not link:\n{}", name, bounded_lines(glslang.log()));
    }
    for (std::size_t i = 0; i < stages.size(); i++) {
      gpu::SpirvStage &made = compiled.emplace_back();
      made.stage = stages[i].stage;
      glslang::GlslangToSpv(*glslang.program().getIntermediate(glslang_language(sources[i]->stage())), made.words);
      optimise(name, made.words);
    }
  });
  return compiled;
}

}  // namespace gnomon::shader_check
