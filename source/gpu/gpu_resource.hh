// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>

namespace gnomon::gpu {

class Device;

enum class ResourceKind : std::uint8_t { Texture, Sampler, Framebuffer, Buffer, Batch, Shader, TimerQuery };

/** Returns "texture", "sampler" and so on. */
[[nodiscard]] std::string_view to_string(ResourceKind kind);

/**
 * Identifies a resource within its device and kind. 0: no resource.
 *
 * The lower bits are an index, the upper bits a generation that increases when the index is reused. A device never
 * issues an id twice for one kind, so the id of a destroyed resource never identifies another resource.
 */
using ResourceId = std::uint32_t;
inline constexpr unsigned resource_index_bits = 20;
/** Maximum number of live resources of one kind. */
inline constexpr std::uint32_t resource_count_max = (1U << resource_index_bits) - 1U;

[[nodiscard]] constexpr std::uint32_t index_of(ResourceId id)
{
  return id & resource_count_max;
}
[[nodiscard]] constexpr std::uint32_t generation_of(ResourceId id)
{
  return id >> resource_index_bits;
}

/**
 * A buffer or a texture of the host: its name in OpenGL, or the VkBuffer or VkImage as a number, as in
 * VkDebugUtilsObjectNameInfoEXT::objectHandle. 0: none.
 */
using HostHandle = std::uint64_t;

/** Shared by a device and its resources. It allows a resource to outlive its device. */
struct DeviceLink {
  /** nullptr after the device was destroyed, or after the packet that creates the resources was lost. */
  Device *device = nullptr;
};

/**
 * Owns one object on the device. Base class of Texture, Buffer, Batch and so on.
 *
 * Move-only. The destructor frees the object; it may run where calls of the device may be made (\see Device). A
 * resource is empty if it was default-constructed or moved from, if its device was destroyed, or if the packet that
 * creates it was lost. An empty resource converts to `false` and its id is 0.
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
