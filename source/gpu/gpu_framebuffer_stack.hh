// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_command_list.hh"

namespace gnomon::gpu {

/**
 * Nested render passes: push suspends the current pass, pop resumes it with its content kept.
 *
 * Records into \a list, which must outlive the stack. A pass that discards an attachment at its end cannot be
 * suspended.
 */
class FramebufferStack {
 public:
  explicit FramebufferStack(CommandList &list) : list_(list) {}

  /** \a framebuffer must live until it is popped. \throws Error where the current pass cannot be suspended. */
  void push(std::string name, const Framebuffer &framebuffer, const PassActions &actions);
  /** \throws Error for an empty stack; nothing changes then. */
  void pop();
  /** \throws Error for an empty stack. */
  [[nodiscard]] const Framebuffer &top() const;
  [[nodiscard]] bool is_empty() const
  {
    return entries_.empty();
  }

 private:
  struct Entry {
    std::string name;
    const Framebuffer *framebuffer = nullptr;
    PassActions actions;
  };
  CommandList &list_;
  std::vector<Entry> entries_;
};

}  // namespace gnomon::gpu
