// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <string>

namespace gnomon::gpu {

/** An OpenGL 4.5 core context. It stays current on the thread that created it until it is destroyed. */
class GlContext {
 public:
  virtual ~GlContext() = default;
  /** Kind of context, such as "EGL surfaceless" or "EGL device 0 (/dev/dri/card0)". */
  [[nodiscard]] virtual std::string description() const = 0;
};

/**
 * Create a context with a hardware EGL device, EGL without a surface, a software EGL device or a hidden window. The
 * kinds are tried in this order. \throws Error naming each kind and the reason why it failed
 */
[[nodiscard]] std::unique_ptr<GlContext> create_headless_context(bool is_debug);

/** The EGL or GLX context that is current on this thread; nullptr if there is none. */
[[nodiscard]] const void *current_context();

}  // namespace gnomon::gpu
