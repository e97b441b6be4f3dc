// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>

namespace gnomon::gpu {

class Device;

enum class ResourceKind : std::uint8_t { Texture, Sampler, Framebuffer, Buffer, Batch, Shader, TimerQuery };

/** "texture", "sampler", … */
[[nodiscard]] std::string_view to_string(ResourceKind kind);

/** Names a resource of one kind within its device, in command lists. 0: none. Reused after destruction. */
using ResourceId = std::uint32_t;

/** What a resource keeps of its device, so that it can outlive it harmlessly. */
struct DeviceLink {
  /** nullptr once the device is gone. */
  Device *device = nullptr;
};

/**
 * Owner of one thing on the device; the base of Texture, Buffer, Batch and the like.
 *
 * Move-only. Destroying it frees the thing, on the device's thread. Default-constructed, moved-from or left over
 * from a device that is gone, it is empty: `false`, id 0.
 */
class Resource {
 public:
  Resource() = default;
  Resource(Resource &&other) noexcept
      : link_(std::move(other.link_)), id_(std::exchange(other.id_, 0)), kind_(other.kind_)
  {
  }
  Resource &operator=(Resource &&other) noexcept;
  ~Resource();

  [[nodiscard]] ResourceId id() const
  {
    return link_ && link_->device ? id_ : 0;
  }
  explicit operator bool() const
  {
    return id() != 0;
  }

 protected:
  friend class Device;
  Resource(std::shared_ptr<DeviceLink> link, ResourceKind kind, ResourceId id)
      : link_(std::move(link)), id_(id), kind_(kind)
  {
  }

 private:
  void release();

  std::shared_ptr<DeviceLink> link_;
  ResourceId id_ = 0;
  ResourceKind kind_ = ResourceKind::Texture;
};

}  // namespace gnomon::gpu
