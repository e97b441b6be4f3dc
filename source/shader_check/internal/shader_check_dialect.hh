// SPDX-License-Identifier: MIT
#pragma once

#include "shader_check.hh"

namespace gnomon::shader_check {

struct TargetChoice {
  CheckTarget target = CheckTarget::OpenGl;
  /** A clause: "FILE:LINE has push_constant". */
  std::string reason;
};

/**
 * The target that stages were written for, as their versions, profiles, extensions and declarations show it, and those
 * of the files that they include. Conditions are not evaluated; lines under a condition weigh less than others.
 */
[[nodiscard]] TargetChoice choose_target(std::span<const Program::File> stages, const gpu::ShaderFiles &files,
                                         std::span<const std::string> folders);

}  // namespace gnomon::shader_check
