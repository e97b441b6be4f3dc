// SPDX-License-Identifier: MIT
#pragma once

#include "gpu_command_list.hh"

namespace gnomon::gpu {

/**
 * Records nested render passes into a command list. push() ends the current pass and begins another; pop() ends that
 * pass and begins the previous one again with its content loaded.
 *
 * The list must outlive the stack. A pass with StoreAction::DontCare cannot be suspended.
 */
class FramebufferStack {
 public:
  explicit FramebufferStack(CommandList &list) : list_(list) {}

  /** \a framebuffer must live until it is popped. \throws Error if the current pass cannot be suspended */
  void push(std::string name, const Framebuffer &framebuffer, const PassActions &actions);
  /** \throws Error if the stack is empty; nothing changes then */
  void pop();
  /** The framebuffer of the current pass. \throws Error if the stack is empty */
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
