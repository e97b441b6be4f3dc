// SPDX-License-Identifier: MIT
// All that a program declares, for people and other programs to read. Any thread may call these functions.
#pragma once

#include "shader_check.hh"

#include <array>
#include <variant>

namespace gnomon::shader_check {

struct StageVariable {
  std::string name;
  /** GLSL's name of the type. */
  std::string type;
  /** -1 if there is none. */
  int location = -1;
  /** Inputs and outputs: the first component within the location, and the input of blending. */
  int component = 0;
  int index = 0;
};

/** A block, texture, image or other resource of a program. */
struct ProgramBinding {
  enum class Kind : std::uint8_t {
    UniformBlock,
    StorageBlock,
    /** A texture, with its sampler or without. */
    Texture,
    Image,
    PushConstants,
    Sampler,
    SubpassInput,
    AccelerationStructure,
    AtomicCounter,
  };
  struct Array {
    /** 0: an array without a size. */
    std::uint32_t count = 0;
    std::uint32_t stride_bytes = 0;
    bool operator==(const Array &) const = default;
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
    /** Distance of the columns of a matrix, or of its rows if it is row-major; 0: no matrix. */
    std::uint32_t matrix_stride_bytes = 0;
    bool is_row_major = false;
    bool operator==(const Member &) const = default;
  };
  Kind kind = Kind::UniformBlock;
  /** For blocks, the name of the block, not of an instance. */
  std::string name;
  /** GLSL's name of the type, with its arrays; empty for blocks. */
  std::string type;
  /** The sizes of arrays of the resource, outermost first; 0: an array without a size. */
  std::vector<int> counts;
  int set = 0;
  /** -1 if the shader gives none. */
  int slot = -1;
  /** Images: GLSL's name of the format; empty if there is none. */
  std::string_view format;
  /** Storage blocks and images: of readonly, writeonly, restrict, coherent and volatile those that hold for the whole.
   */
  std::vector<std::string_view> qualifiers;
  /** Subpass inputs: `input_attachment_index`; -1 for others. */
  int attachment = -1;
  /** Atomic counters: the place in the buffer of the slot. */
  std::uint32_t offset_bytes = 0;
  /**
   * For blocks: the end of the last member, and in OpenGL, for uniform blocks, the end of its row of 16 bytes. An array
   * without a size counts as empty.
   */
  std::uint32_t size_bytes = 0;
  std::vector<Member> members;
  /** The stages that use it. */
  std::vector<Stage> stages;
  bool operator==(const ProgramBinding &) const = default;
};

/** "uniform", "storage", "texture", "image", "push constants", "sampler", "subpass input" and so on. */
[[nodiscard]] std::string_view to_string(ProgramBinding::Kind kind);

/** A specialisation constant. */
struct ProgramConstant {
  /** Empty for those of `local_size_x_id`. */
  std::string name;
  /** GLSL's name of the type. */
  std::string type;
  /** `constant_id`. */
  std::uint32_t id = 0;
  std::variant<bool, std::int64_t, std::uint64_t, double> value;
  bool operator==(const ProgramConstant &) const = default;
};

/** The size of the workgroups of a compute, task or mesh stage. */
struct Workgroup {
  Stage stage = Stage::Compute;
  std::array<std::uint32_t, 3> size{};
  /** The specialisation constants that set it; -1: none. */
  std::array<int, 3> constant_ids{-1, -1, -1};
};

struct ProgramInterface {
  CheckTarget target = CheckTarget::OpenGlSpirv;
  std::vector<Stage> stages;
  /** Inputs of the first stage and outputs of the last, both sorted by location. */
  std::vector<StageVariable> inputs;
  std::vector<StageVariable> outputs;
  /**
   * Uniforms outside of blocks that a stage uses, sorted by location. Only OpenGL has them. Structs are listed by their
   * members, such as `lights[0].color`, and an array of structs by its first element.
   */
  std::vector<StageVariable> uniforms;
  /**
   * Bindings that a stage uses, sorted by kind, set, slot and name. Several stages share one only if it is the same in
   * them.
   */
  std::vector<ProgramBinding> bindings;
  /** Sorted by id. */
  std::vector<ProgramConstant> constants;
  std::vector<Workgroup> workgroups;
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
