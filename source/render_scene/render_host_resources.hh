// SPDX-License-Identifier: MIT
#pragma once

#include "scene_handle.hh"

#include <cstdint>
#include <map>
#include <optional>

namespace gnomon::render_scene {

/** The changes that an update has found in resources of the host. */
struct HostChanges {
  /** Their content may have changed. */
  bool content = false;
  /** Their names, layouts or sizes may have changed, too, so that passes must be built again. */
  bool resources = false;
};

/**
 * The resources of the host that meshes or images of a scene have on one device. \a Thing: scene::Mesh or scene::Image.
 * \a Resource: gpu::HostBatch or gpu::HostTexture.
 */
template <typename Thing, typename Resource>
class HostResources {
 public:
  /** Effective with the next update(). std::nullopt takes the resource back. */
  void set(scene::Handle<Thing> handle, const std::optional<Resource> &resource)
  {
    pending_[handle] = resource;
  }

  /** Apply the calls of set(), and forget things that \a is_kept does not accept. */
  template <typename IsKept>
  HostChanges update(IsKept &&is_kept)
  {
    HostChanges changes;
    for (const auto &[handle, resource] : pending_) {
      const auto before = current_.find(handle);
      const bool has_resource = before != current_.end();
      const bool is_same = has_resource ? resource == before->second.resource : !resource.has_value();
      changes.content |= resource || has_resource;
      changes.resources |= !is_same;
      revision_++;
      if (resource) {
        current_[handle] = {*resource, is_same ? before->second.resource_revision : revision_, revision_};
      }
      else {
        current_.erase(handle);
      }
    }
    pending_.clear();
    std::erase_if(current_, [&](const auto &entry) { return !is_kept(entry.first); });
    return changes;
  }

  /** nullptr: the thing has no resource of the host. */
  [[nodiscard]] const Resource *find(scene::Handle<Thing> handle) const
  {
    const auto found = current_.find(handle);
    return found == current_.end() ? nullptr : &found->second.resource;
  }
  /** Changes with each set() that was applied. 0: the thing has no resource of the host. */
  [[nodiscard]] std::uint64_t content_revision(scene::Handle<Thing> handle) const
  {
    const auto found = current_.find(handle);
    return found == current_.end() ? 0 : found->second.content_revision;
  }
  /** Changes with each applied set() of another resource. 0: the thing has no resource of the host. */
  [[nodiscard]] std::uint64_t resource_revision(scene::Handle<Thing> handle) const
  {
    const auto found = current_.find(handle);
    return found == current_.end() ? 0 : found->second.resource_revision;
  }
  /** Increases with each set() that was applied. */
  [[nodiscard]] std::uint64_t revision() const
  {
    return revision_;
  }

 private:
  struct Entry {
    Resource resource;
    std::uint64_t resource_revision = 0;
    std::uint64_t content_revision = 0;
  };
  std::map<scene::Handle<Thing>, Entry> current_;
  std::map<scene::Handle<Thing>, std::optional<Resource>> pending_;
  std::uint64_t revision_ = 0;
};

}  // namespace gnomon::render_scene
