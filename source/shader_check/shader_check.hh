// SPDX-License-Identifier: MIT
// Finds mistakes in shaders before they run. Needs no driver and no device.
#pragma once

#include "gpu_shader.hh"

#include <span>

namespace gnomon::shader_check {

enum class CheckTarget : std::uint8_t {
  /** SPIR-V for OpenGL 4.5. */
  OpenGl,
  /** SPIR-V for Vulkan 1.2. */
  Vulkan,
};

[[nodiscard]] std::string_view to_string(CheckTarget target);

enum class Severity : std::uint8_t { Warning, Error };

[[nodiscard]] std::string_view to_string(Severity severity);

/** A kind of mistake. Messages contain its name. */
struct CheckRule {
  std::string_view name;
  std::string_view purpose;
};

/** All rules. */
[[nodiscard]] std::span<const CheckRule> check_rules();

struct CheckMessage {
  Severity severity = Severity::Error;
  std::string file;
  /** From 1. */
  int line = 1;
  std::string text;
  /** CheckRule::name. */
  std::string_view rule;
  std::string shader;
  /** The defines, separated by spaces; may be empty. */
  std::string variant;
  CheckTarget target = CheckTarget::OpenGl;

  bool operator==(const CheckMessage &) const = default;
};

struct CheckOptions {
  CheckTarget target = CheckTarget::OpenGl;
  /** Each uniform and storage block must be one of these and have its layout; empty: layouts are not checked. */
  std::span<const gpu::BlockLayout> blocks;
  /** A uniform block above UNIFORM_BLOCK_BYTES_MAX, which every device supports, is an error, not a warning. */
  bool is_block_size_strict = false;
  gpu::IncludePath include_path;
};

/**
 * Compiles each stage of \a desc to SPIR-V, validates it, links, and reports mistakes that compilers accept. To check a
 * single stage, leave the paths of the other stages empty.
 *
 * Mistakes in the shader are returned as messages, never as exceptions. Texts of messages have at most about 400 bytes.
 * Several threads may call the function concurrently if \a files allows it.
 * \return the mistakes, sorted by file and line; empty if none was found.
 */
[[nodiscard]] std::vector<CheckMessage> check_shader(const gpu::ShaderDesc &desc, const gpu::ShaderFiles &files,
                                                     const CheckOptions &options);

}  // namespace gnomon::shader_check
