// SPDX-License-Identifier: MIT
// What can be told of a shader before it runs, without driver and device.
#pragma once

#include "gpu_shader.hh"

#include <span>

namespace gnomon::gpu {

enum class CheckTarget : std::uint8_t {
  /** SPIR-V for OpenGL 4.5. */
  OpenGl,
  /** SPIR-V for Vulkan 1.2. */
  Vulkan,
};

[[nodiscard]] std::string_view to_string(CheckTarget target);

enum class Severity : std::uint8_t { Warning, Error };

[[nodiscard]] std::string_view to_string(Severity severity);

/** What a check looks for. Its name stands in messages. */
struct CheckRule {
  std::string_view name;
  std::string_view purpose;
};

/** All of them. */
[[nodiscard]] std::span<const CheckRule> check_rules();

struct CheckMessage {
  Severity severity = Severity::Error;
  std::string file;
  /** From 1. */
  int line = 1;
  std::string text;
  /** A CheckRule's name. */
  std::string_view rule;
  std::string shader;
  /** "" or defines, a space between two. */
  std::string variant;
  CheckTarget target = CheckTarget::OpenGl;

  bool operator==(const CheckMessage &) const = default;
};

/** A block as C++ has it. */
struct BlockLayout {
  struct Field {
    /** As reflection names it, of an array the first element: `light_data.lights[0].color`. */
    std::string_view name;
    std::size_t offset_bytes;
  };
  /** Of the block in GLSL. */
  std::string_view name;
  /** Of a storage block that is an array: of an entry. */
  std::size_t size_bytes;
  std::span<const Field> fields;
};

struct CheckOptions {
  CheckTarget target = CheckTarget::OpenGl;
  /** Each uniform and storage block must be one of them, laid out alike; empty: nothing is known of blocks. */
  std::span<const BlockLayout> blocks;
  /** A uniform block larger than what every device takes (UNIFORM_BLOCK_BYTES_MAX) is an error, not a warning. */
  bool is_block_size_strict = false;
  IncludePath include_path;
};

/**
 * Compile each stage of \a desc to SPIR-V, validate, link, and look for what compilers let pass. A single stage, too,
 * may be checked: leave the others' paths empty.
 *
 * Never throws for a mistake in the shader. May run on several threads at once if \a files may.
 * \return empty: nothing to complain about. Sorted by file and line.
 */
[[nodiscard]] std::vector<CheckMessage> check_shader(const ShaderDesc &desc, const ShaderFiles &files,
                                                     const CheckOptions &options);

/** A block as C++ and GLSL have it. */
struct BlockComparison {
  struct Field {
    /** Of GLSL; empty: the field stands in the block itself. */
    std::string structure;
    /** As in BlockLayout. */
    std::string name;
    std::optional<std::size_t> cpp_offset_bytes;
    std::optional<std::size_t> glsl_offset_bytes;
    /** Of the field in GLSL, else of what should hold it. */
    std::string file;
    int line = 1;
  };
  std::string block;
  std::size_t cpp_size_bytes = 0;
  std::size_t glsl_size_bytes = 0;
  /** In the order of GLSL; behind them those that only C++ has. */
  std::vector<Field> fields;
  /** Of the block in GLSL. */
  std::string file;
  int line = 1;
};

/**
 * The blocks that \a desc reads and that \a blocks has, too.
 *
 * \throws Error where it does not compile.
 */
[[nodiscard]] std::vector<BlockComparison> compare_blocks(const ShaderDesc &desc, const ShaderFiles &files,
                                                          std::span<const BlockLayout> blocks);

/** What differs, one sentence each; empty: laid out alike. */
struct BlockDifference {
  std::string file;
  int line = 1;
  std::string text;
};
[[nodiscard]] std::vector<BlockDifference> differences(const BlockComparison &comparison);

struct StageVariable {
  std::string name;
  std::string type;
  /** -1: none. */
  int location = -1;
};

/** What enters the first stage and leaves the last. */
struct StageVariables {
  std::vector<StageVariable> inputs;
  std::vector<StageVariable> outputs;
};

/** \throws Error where it does not compile. */
[[nodiscard]] StageVariables stage_variables(const ShaderDesc &desc, const ShaderFiles &files);

}  // namespace gnomon::gpu
