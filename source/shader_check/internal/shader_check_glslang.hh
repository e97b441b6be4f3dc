// SPDX-License-Identifier: MIT
// glslang, for reflection and for checks.
#pragma once

#include "shader_check_sources.hh"

#include <glslang/Public/ShaderLang.h>

#include <functional>
#include <memory>

namespace gnomon::shader_check {

/**
 * Runs \a work on a thread with a stack of 512 MiB and waits for it. glslang recurses for each operator of an
 * expression: 100 000 operators overflow a usual stack of 8 MiB. The large stack suffices for 1 MiB of text, but not
 * for macros that expand a short text to millions of operators.
 *
 * \throws what \a work throws; Error if there is no memory for the thread.
 */
void with_large_stack(const std::function<void()> &work);

[[nodiscard]] EShLanguage glslang_language(Stage stage);

/** The stages of one shader. Threads may use different programs concurrently. Call it only within with_large_stack. */
class GlslangProgram {
 public:
  explicit GlslangProgram(StageErrors errors = StageErrors::First);

  /**
   * Compiles \a source, which must outlive the program. false on failure: log() has the reason. Sources of more than
   * stage_bytes_max are refused. \a needs_slots: whether the target's rules about missing locations and bindings apply.
   */
  bool add(StageSource &source, CheckTarget target, bool needs_slots = true);
  /** \a source after the preprocessor; up to its first mistake if it has one. */
  [[nodiscard]] std::string preprocessed(StageSource &source, CheckTarget target);
  /** Call it after adding all stages. false on failure: log() has the reason. */
  bool link();
  /** Log of the last call. */
  [[nodiscard]] std::string_view log() const
  {
    return log_;
  }
  /** The tree of an added source by itself. Linking may add those of others to it. */
  [[nodiscard]] const glslang::TIntermediate *tree(std::size_t source) const
  {
    return shaders_[source]->getIntermediate();
  }
  [[nodiscard]] glslang::TProgram &program()
  {
    return *program_;
  }

 private:
  std::vector<std::unique_ptr<glslang::TShader>> shaders_;
  /** Declared after the shaders, because it refers to them until it is destroyed. */
  std::unique_ptr<glslang::TProgram> program_;
  std::string log_;
  EShMessages messages_;
};

/** The blocks and textures of a linked program. */
[[nodiscard]] gpu::ShaderInterface interface_of(glslang::TProgram &program);

}  // namespace gnomon::shader_check
