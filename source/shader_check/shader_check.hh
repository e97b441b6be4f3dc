// SPDX-License-Identifier: MIT
// Finds mistakes in shaders before they run. Needs no driver and no device.
#pragma once

#include "gpu_shader.hh"

#include <map>
#include <span>

namespace gnomon::shader_check {

/** The target that a shader is compiled for. */
enum class CheckTarget : std::uint8_t {
  /** GLSL as a driver of OpenGL compiles it, 1.10 to 4.60. */
  OpenGl,
  /** SPIR-V for OpenGL 4.5: GL_ARB_gl_spirv. */
  OpenGlSpirv,
  /** GLSL as a driver of OpenGL ES compiles it, 1.00 to 3.20. */
  Es,
  Vulkan10,
  Vulkan11,
  Vulkan12,
  Vulkan13,
};

struct TargetName {
  CheckTarget target;
  /** The name as an option of the command line. */
  std::string_view name;
  /** The name as people write it. */
  std::string_view text;
};

/** All targets. */
[[nodiscard]] std::span<const TargetName> check_targets();
/** TargetName::text. */
[[nodiscard]] std::string_view to_string(CheckTarget target);
[[nodiscard]] bool is_vulkan(CheckTarget target);
/** Whether shaders for \a target become SPIR-V. */
[[nodiscard]] bool has_spirv(CheckTarget target);

/** In the order in which a device runs them. */
enum class Stage : std::uint8_t {
  Vertex,
  TessControl,
  TessEvaluation,
  Geometry,
  Task,
  Mesh,
  Fragment,
  Compute,
  RayGeneration,
  Intersection,
  AnyHit,
  ClosestHit,
  Miss,
  Callable,
};

struct StageName {
  Stage stage;
  /** The ending of a file's name, without its dot. */
  std::string_view ending;
  std::string_view text;
};

/** All stages. */
[[nodiscard]] std::span<const StageName> stage_names();
/** StageName::text. */
[[nodiscard]] std::string_view to_string(Stage stage);

/** A stage has at most this size with its includes. */
inline constexpr std::size_t stage_bytes_max = 1U << 20U;

enum class Severity : std::uint8_t { Warning, Error };

[[nodiscard]] std::string_view to_string(Severity severity);

/** A kind of mistake. Messages contain its name. */
struct CheckRule {
  std::string_view name;
  std::string_view purpose;
  /** Whether its level can be set. Without the mistakes of other rules a shader cannot run. */
  bool is_optional = false;
  /** Whether only Gnomon's own shaders need it: for others it is off until its level is set. */
  bool is_own = false;
  enum class Reads : std::uint8_t { Compiler, Declarations, Functions };
  /** The source of the findings: messages of compilers, declarations or functions. */
  Reads reads = Reads::Compiler;
};

/** All rules. doc/shader-rules.md has an example of each. */
[[nodiscard]] std::span<const CheckRule> check_rules();

/**
 * The names of rules that this build cannot check for \a target, because it was made without the headers of glslang's
 * syntax tree, which glslang installs before version 14 only. Without them, declarations are read from SPIR-V.
 */
[[nodiscard]] std::vector<std::string_view> left_out_rules(CheckTarget target);

enum class RuleLevel : std::uint8_t { Off, Warning, Error };

/** Levels by CheckRule::name. Other rules have their usual level. */
using RuleLevels = std::map<std::string, RuleLevel, std::less<>>;

struct CheckMessage {
  Severity severity = Severity::Error;
  std::string file;
  /** From 1; 0: none, as a `#line` has made it negative. */
  int line = 1;
  std::string text;
  /** CheckRule::name. */
  std::string_view rule;
  std::string shader;
  /** The defines, separated by spaces; may be empty. */
  std::string variant;
  CheckTarget target = CheckTarget::OpenGlSpirv;
  /** From 1; 0: unknown. */
  int column = 0;

  bool operator==(const CheckMessage &) const = default;
};

/** The errors of a stage that are reported. */
enum class StageErrors : std::uint8_t {
  /** The errors before glslang stops, which is at the first error of most kinds. */
  First,
  /** All, as glslc reports. Some mistakes crash glslang then: use it in a process that may end. */
  All,
};

struct CheckOptions {
  CheckTarget target = CheckTarget::OpenGlSpirv;
  /** Each uniform and storage block must be one of these and have its layout; empty: layouts are not checked. */
  std::span<const gpu::BlockLayout> blocks;
  /** A uniform block above UNIFORM_BLOCK_BYTES_MAX, which every device supports, is an error, not a warning. */
  bool is_block_size_strict = false;
  RuleLevels levels;
  /** Warnings are errors. */
  bool is_strict = false;
  StageErrors stage_errors = StageErrors::First;
};

/**
 * Compiles each stage of \a desc, links, and reports mistakes that compilers accept. For a target with SPIR-V, it is
 * validated, too. To check a single stage, leave the paths of the other stages empty.
 *
 * Mistakes in the shader are returned as messages, never as exceptions. Texts of messages have at most about 400 bytes.
 * Several threads may call the function concurrently if \a files allows it.
 * \return the mistakes: those of the compiler in its order, then others by file and line; empty if none was found.
 */
[[nodiscard]] std::vector<CheckMessage> check_shader(const gpu::ShaderDesc &desc, const gpu::ShaderFiles &files,
                                                     const CheckOptions &options);

/** A program of others: any stages, any dialect. */
struct Program {
  struct File {
    Stage stage;
    std::string path;
  };
  std::string name;
  /** The files, in any order. CheckTarget::OpenGl alone allows several of one stage. */
  std::vector<File> files;
  /** "NAME" or "NAME value", defined in every stage. */
  std::vector<std::string> defines;
};

struct ProgramOptions {
  /** Empty: as the files say. */
  std::optional<CheckTarget> target;
  /** Folders in which includes are sought after that of the including file. */
  std::vector<std::string> include_folders;
  RuleLevels levels;
  /** Warnings are errors. */
  bool is_strict = false;
  /** Names of device_features() that the shaders may use. */
  std::vector<std::string> features;
  StageErrors stage_errors = StageErrors::First;
};

/** Features of devices that allow SPIR-V which the target otherwise forbids, by their names in Vulkan. */
[[nodiscard]] std::span<const std::string_view> device_features();

struct ProgramCheck {
  std::vector<CheckMessage> messages;
  CheckTarget target = CheckTarget::OpenGl;
  /** Why the files have that target; empty if it was given. */
  std::string target_reason;
  /** Files that were read, and paths at which an include was sought in vain: the result depends on them. */
  std::vector<std::string> files;
  std::vector<std::string> absent;
  /** SPIR-V of each stage, in the order of stages; empty if there is an error, and for targets without SPIR-V. */
  std::vector<std::pair<Stage, std::vector<std::uint32_t>>> spirv;

  [[nodiscard]] bool has_errors() const;
};

/**
 * The same as check_shader(), for shaders that were not written for Gnomon: glslang itself reads includes and
 * conditions, and rules that only Gnomon's own shaders need are off.
 */
[[nodiscard]] ProgramCheck check_program(const Program &program, const gpu::ShaderFiles &files,
                                         const ProgramOptions &options);

}  // namespace gnomon::shader_check
