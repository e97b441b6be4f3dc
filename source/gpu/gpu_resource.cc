// SPDX-License-Identifier: MIT
#include "gpu_resource.hh"

#include "gpu_device.hh"

namespace gnomon::gpu {

std::string_view to_string(ResourceKind kind)
{
  switch (kind) {
    case ResourceKind::Texture: return "texture";
    case ResourceKind::Sampler: return "sampler";
    case ResourceKind::Framebuffer: return "framebuffer";
    case ResourceKind::Buffer: return "buffer";
    case ResourceKind::Batch: return "batch";
    case ResourceKind::Shader: return "shader";
    case ResourceKind::TimerQuery: return "timer query";
  }
  return "?";
}

Resource &Resource::operator=(Resource &&other) noexcept
{
  if (this != &other) {
    release();
    link_ = std::move(other.link_);
    id_ = std::exchange(other.id_, 0);
    kind_ = other.kind_;
  }
  return *this;
}

Resource::~Resource()
{
  release();
}

void Resource::release()
{
  if (const ResourceId id = this->id()) {
    link_->device->release(kind_, id);
  }
  link_.reset();
  id_ = 0;
}

}  // namespace gnomon::gpu
