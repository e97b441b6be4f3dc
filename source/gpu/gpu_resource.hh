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

/**
 * Names a resource of one kind within its device, in command lists. 0: none.
 *
 * The lower bits are an index, the upper bits a generation that increases whenever the index is used again. A device
 * never issues an id twice, so the id of a destroyed resource never names another resource.
 */
using ResourceId = std::uint32_t;
inline constexpr unsigned resource_index_bits = 20;
/** Live resources of one kind that a device can hold. */
inline constexpr std::uint32_t resource_count_max = (1U << resource_index_bits) - 1U;

[[nodiscard]] constexpr std::uint32_t index_of(ResourceId id)
{
  return id & resource_count_max;
}
[[nodiscard]] constexpr std::uint32_t generation_of(ResourceId id)
{
  return id >> resource_index_bits;
}

/** Shared by a device and its resources, so that a resource may outlive its device. */
struct DeviceLink {
  /** nullptr once the device is destroyed. */
  Device *device = nullptr;
};

/**
 * Owner of one object on the device; the base of Texture, Buffer, Batch and the like.
 *
 * Move-only. Its destructor frees the object and must run on the device's thread. A resource that is
 * default-constructed, moved from, or older than its device's destruction is empty: it converts to `false` and its id
 * is 0.
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
