// SPDX-License-Identifier: MIT
#pragma once

#include "shader_check_glslang.hh"
#include "shader_check_stage.hh"

namespace gnomon::shader_check {

/** One shader for one target: its sources, glslang's program, and facts about its stages. */
struct Compilation {
  /** In the order of stages. */
  std::vector<std::unique_ptr<StageSource>> sources;
  std::vector<SourceLines> lines;
  GlslangProgram glslang;
  /** Parallel to sources; empty until linked. */
  std::vector<StageFacts> facts;

  [[nodiscard]] const glslang::TIntermediate *tree(std::size_t stage)
  {
    return glslang.program().getIntermediate(glslang_language(sources[stage]->stage()));
  }
  /** Compiles the next stage. */
  bool add(std::unique_ptr<StageSource> source, CheckTarget target);
  void read_facts();
  /** Path of the file at a position in a stage. */
  [[nodiscard]] const std::string &file(std::size_t stage, SourcePosition position) const;
};

/** Compiles and links for OpenGL, and reads the facts. \throws Error if \a desc does not compile. */
void compile(const gpu::ShaderDesc &desc, const gpu::ShaderFiles &files, Compilation &compilation);

/** A declaration and the index of its stage. */
struct StageDeclaration {
  std::size_t stage;
  const Declaration *declaration;
};

/** The declaration of the uniform or storage block \a name in the first stage that contains it. */
[[nodiscard]] std::optional<StageDeclaration> find_block(const Compilation &compilation, gpu::BindingKind kind,
                                                         std::string_view name);

}  // namespace gnomon::shader_check
