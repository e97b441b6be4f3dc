// SPDX-License-Identifier: MIT
// All that a program declares, for people and other programs to read. Any thread may call these functions.
#pragma once

#include "shader_check.hh"

namespace gnomon::shader_check {

struct StageVariable {
  std::string name;
  /** GLSL's name of the type. */
  std::string type;
  /** -1 if there is none. */
  int location = -1;
};

/** A block, texture or image of a program. */
struct ProgramBinding {
  enum class Kind : std::uint8_t { UniformBlock, StorageBlock, Texture, Image, PushConstants };
  struct Array {
    /** 0: an array without a size. */
    std::uint32_t count = 0;
    std::uint32_t stride_bytes = 0;
  };
  struct Member {
    /** Path in the block, such as `lights[0].color`. An array of structs is listed by its first element. */
    std::string name;
    /** GLSL's name of the type. */
    std::string type;
    std::uint32_t offset_bytes = 0;
    std::uint32_t size_bytes = 0;
    /** The arrays of the path and of the type, the outermost first. */
    std::vector<Array> arrays;
  };
  Kind kind = Kind::UniformBlock;
  /** For blocks, the name of the block, not of an instance. */
  std::string name;
  /** Type of a texture or an image; empty for blocks. */
  std::string type;
  int set = 0;
  /** -1 if the shader gives none. */
  int slot = -1;
  /**
   * For blocks: the end of the last member, and in OpenGL, for uniform blocks, the end of its row of 16 bytes. An array
   * without a size counts as empty.
   */
  std::uint32_t size_bytes = 0;
  std::vector<Member> members;
  /** The stages that use it. */
  std::vector<Stage> stages;
};

/** "uniform", "storage", "texture", "image", "push constants". */
[[nodiscard]] std::string_view to_string(ProgramBinding::Kind kind);

struct ProgramInterface {
  CheckTarget target = CheckTarget::OpenGlSpirv;
  std::vector<Stage> stages;
  /** Inputs of the first stage and outputs of the last, both sorted by location. */
  std::vector<StageVariable> inputs;
  std::vector<StageVariable> outputs;
  /**
   * Those outside of blocks that a stage uses, sorted by location. Only OpenGL has them. Structs are listed by their
   * members, such as `lights[0].color`, and an array of structs by its first element.
   */
  std::vector<StageVariable> uniforms;
  /** Those that a stage uses, sorted by kind, set, slot and name. */
  std::vector<ProgramBinding> bindings;
};

/** \throws gpu::Error if \a desc does not compile. */
[[nodiscard]] ProgramInterface program_interface(const gpu::ShaderDesc &desc, const gpu::ShaderFiles &files);

/**
 * The same for shaders of others. Without a target in \a options it is that of the files, as check_program() chooses
 * it. For a target without SPIR-V, the program is read as SPIR-V for OpenGL, without its rules about locations and
 * bindings.
 *
 * \throws gpu::Error with each error of check_program() on a line
 */
[[nodiscard]] ProgramInterface program_interface(const Program &program, const gpu::ShaderFiles &files,
                                                 const ProgramOptions &options);

}  // namespace gnomon::shader_check
