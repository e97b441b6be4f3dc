// SPDX-License-Identifier: MIT
#pragma once

#include "shader_check.hh"

#include "shader_check_compilation.hh"
#include "shader_check_log.hh"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/** Internal to source/shader_check. */
namespace gnomon::shader_check {

/** The settings of a Checker. */
struct CheckSettings {
  CheckOptions options;
  /** Whether the shaders are Gnomon's, to which rules with CheckRule::is_own apply. */
  bool is_own = true;
  std::span<const std::string> features;
};

/** Checks the stages of one program for one target. Call compile for each of them in their order, then finish. */
class Checker {
 public:
  Checker(std::string name, const std::vector<std::string> &defines, const CheckSettings &settings);
  /** A stage that cannot be read or linked. */
  void refuse(std::string_view rule, std::string file, int line, std::string_view text);
  /** Compiles the next stage. */
  void compile(std::unique_ptr<StageSource> source);
  /** Links the stages and checks them together. */
  void finish();
  /** Takes them. */
  [[nodiscard]] std::vector<CheckMessage> messages();
  [[nodiscard]] const Compilation &compilation() const;
  /** Takes the SPIR-V of the stages. Empty: the target has none, or they do not link. */
  [[nodiscard]] std::vector<std::pair<Stage, std::vector<std::uint32_t>>> spirv();

 private:
  /** The severity of a mistake; empty: it is not reported. \a set: a level that a comment gives. */
  [[nodiscard]] std::optional<Severity> severity_of(Severity usual, std::string_view name,
                                                    std::optional<RuleLevel> set) const;
  void add(Severity usual, std::string_view rule, std::string file, int line, std::string_view text);
  void add(Severity usual, std::string_view rule, std::size_t stage, SourcePosition position, std::string_view text);
  [[nodiscard]] bool has_errors() const;
  void check_byte_order_mark(const StageSource &source);
  /** Reports files that are no text of GLSL. \return whether there is one */
  [[nodiscard]] bool check_bytes(const StageSource &source);
  /** glslang takes any version for any target without SPIR-V. */
  void check_version(const StageSource &source);
  void link_stages();
  /**
   * Whether all of \a errors are differences between stages that Vulkan, which connects stages by number and not by
   * name, allows.
   */
  [[nodiscard]] bool may_differ(const std::vector<LinkMessage> &errors) const;
  void add_block_differences(const std::vector<LinkMessage> &errors);
  /** The stage that a link error is about, and the first declaration in it that the error names. */
  [[nodiscard]] std::pair<std::size_t, SourcePosition> place_of(std::string_view text) const;
  /** Blocks of one name that are uniform in one stage and storage in another, about which glslang is silent. */
  void check_kinds();
  void check_findings();
  void check_slots();
  /** Whether \a error is about the precision of a uniform that GLSL ES 1.00 compares only if two stages use it. */
  [[nodiscard]] bool is_about_unused_uniform(const LinkMessage &error) const;
  /** Uniforms of OpenGL that share a location, about which glslang is silent. */
  void check_uniform_locations();
  /** Whether the devices have a feature of device_features(). */
  [[nodiscard]] bool has_feature(std::string_view name) const;
  /** Whether an input may be a part of a vector that the previous stage writes: since Vulkan 1.3, or maintenance4. */
  [[nodiscard]] bool is_part(const Declaration &output, const Declaration &input) const;
  /** OpenGL ES links stages of one version, and none with one of the desktop. glslang links any. */
  void check_versions();
  /** Interpolation and `invariant`, which drivers of OpenGL compare and glslang does not. */
  void check_qualifiers(std::size_t stage, const Declaration &input, const Declaration &output);
  /** An input and an output that are structs. Their members are compared in their order; names may differ. */
  void check_members(std::size_t stage, const Declaration &input, const Declaration &output);
  /** The text of the stage before that of the source \a stage. */
  [[nodiscard]] std::string_view stage_before(std::size_t stage) const;
  /** \a outputs: those of the stage before. */
  void check_input(std::size_t stage, const Declaration &input, const std::vector<StageDeclaration> &outputs);
  void check_varyings();
  void check_unused_bindings();
  void check_blocks();
  void check_block_size(std::size_t stage, const Declaration &block);
  void make_spirv();
  /** The place of the first mistake in the SPIR-V of \a stage that SPIRV-Tools finds. */
  [[nodiscard]] SourcePosition place_in_spirv(std::size_t stage);
  /** \a text: messages about how \a words were made. */
  void validate(std::size_t stage, const std::vector<std::uint32_t> &words, std::string text);

  std::string name_;
  const CheckOptions &options_;
  const CheckSettings &settings_;
  std::string variant_;
  bool is_compiled_ = true;
  Compilation c_;
  std::vector<CheckMessage> messages_;
  std::vector<std::pair<Stage, std::vector<std::uint32_t>>> spirv_;
};

}  // namespace gnomon::shader_check
