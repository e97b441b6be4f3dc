// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

namespace gnomon::gpu {

/** An OpenGL 4.5 core context, current on the thread that made it until it is destroyed. */
class GlContext {
 public:
  virtual ~GlContext() = default;
  /** "EGL surfaceless", … */
  [[nodiscard]] virtual std::string description() const = 0;
};

/** \throws Error naming each way that was tried and why it failed. */
[[nodiscard]] std::unique_ptr<GlContext> create_headless_context(bool is_debug);

/** Whether any context, EGL's or GLX's, is current on this thread. */
[[nodiscard]] bool has_current_context();

}  // namespace gnomon::gpu
