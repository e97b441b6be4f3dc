// SPDX-License-Identifier: MIT
#include "gpu_framebuffer_stack.hh"

#include "gpu_error.hh"

namespace gnomon::gpu {

void FramebufferStack::push(std::string name, const Framebuffer &framebuffer, const PassActions &actions)
{
  if (!entries_.empty()) {
    const Entry &below = entries_.back();
    if (below.actions.color_store == StoreAction::DontCare || below.actions.depth_store == StoreAction::DontCare) {
      throw Error("pass '{}' cannot begin inside pass '{}', which discards an attachment at its end", name, below.name);
    }
    list_.end_pass();
  }
  list_.begin_pass(name, framebuffer, actions);
  entries_.push_back({std::move(name), &framebuffer, actions});
}

void FramebufferStack::pop()
{
  if (entries_.empty()) {
    throw Error("framebuffer stack: pop without a push");
  }
  list_.end_pass();
  entries_.pop_back();
  if (!entries_.empty()) {
    Entry &entry = entries_.back();
    entry.actions.color_load = LoadAction::Load;
    entry.actions.depth_load = LoadAction::Load;
    list_.begin_pass(entry.name, *entry.framebuffer, entry.actions);
  }
}

const Framebuffer &FramebufferStack::top() const
{
  if (entries_.empty()) {
    throw Error("framebuffer stack: top of an empty stack");
  }
  return *entries_.back().framebuffer;
}

}  // namespace gnomon::gpu
