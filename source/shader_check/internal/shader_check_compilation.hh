// SPDX-License-Identifier: MIT
#pragma once

#include "shader_check_glslang.hh"
#include "shader_check_stage.hh"

namespace gnomon::shader_check {

/** A stage in SPIR-V, and messages about how it was made. */
struct Spirv {
  std::vector<std::uint32_t> words;
  std::string log;
};

/** One shader for one target: its sources, glslang's program, and facts about its stages. */
struct Compilation {
  explicit Compilation(StageErrors errors = StageErrors::First) : glslang(errors) {}

  /** In the order of stages. OpenGL may have several of one stage. */
  std::vector<std::unique_ptr<StageSource>> sources;
  std::vector<SourceLines> lines;
  GlslangProgram glslang;
  /** Parallel to sources; empty until linked. Sources of one stage have facts of their own. */
  std::vector<StageFacts> facts;

  /**
   * Compiles the next stage. The target is the same for all. \a needs_slots: as for GlslangProgram::add(). \a
   * has_lines: whether `lines` are read; without them, facts have no positions.
   */
  bool add(std::unique_ptr<StageSource> source, CheckTarget target, bool needs_slots = true, bool has_lines = true);
  /** The sources of one stage: the index of the first, and one behind the last. */
  struct Range {
    std::size_t begin;
    std::size_t end;
    [[nodiscard]] std::size_t size() const
    {
      return end - begin;
    }
  };
  /** The sources of the stage of \a source. */
  [[nodiscard]] Range stage_of(std::size_t source) const;
  /** Links the sources, as GlslangProgram::link() does. Call it once, after all sources. */
  bool link();
  /** The stage in SPIR-V. Call it after linking, for targets with SPIR-V. */
  const Spirv &spirv(std::size_t stage);
  /** The same with the lines of instructions. */
  [[nodiscard]] std::vector<std::uint32_t> spirv_with_lines(std::size_t stage);
  /**
   * Call it after linking; \a is_sound: the stages are without mistakes, apart from differences between them. Without
   * glslang's tree, the facts of other stages, and those for targets without SPIR-V, are empty.
   */
  void read_facts(bool is_sound, bool with_mistakes);
  /** Path of the file at a position in a stage. */
  [[nodiscard]] const std::string &file(std::size_t stage, SourcePosition position) const;

 private:
  [[nodiscard]] const glslang::TIntermediate *tree(std::size_t stage)
  {
    return glslang.program().getIntermediate(glslang_language(sources[stage]->stage()));
  }

  CheckTarget target_ = CheckTarget::OpenGl;
  /** Parallel to sources; those without words are not made yet. */
  std::vector<Spirv> spirv_;
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
