// SPDX-License-Identifier: MIT
#include "internal/eevee_frame_check.hh"

#include "internal/eevee_frame.hh"

#include "gpu_device.hh"

#include <algorithm>

namespace gnomon::eevee {

using gpu::ResourceKind;

static bool is_named(const std::vector<std::string_view> &names, std::string_view name)
{
  return std::ranges::find(names, name) != names.end();
}

static bool is_named(const std::vector<FrameRead> &reads, std::string_view name)
{
  return std::ranges::find(reads, name, &FrameRead::name) != reads.end();
}

void FrameCheck::collect(const gpu::CommandList &list, const gpu::Device &device, bool has_attachments)
{
  reads_.clear();
  writes_.clear();
  for (const gpu::Command &command : list.commands()) {
    switch (command.kind) {
      case gpu::CommandKind::BeginPass: {
        attachments_.clear();
        const gpu::PassActions &actions = list.passes()[command.first].actions;
        const gpu::ResourceInfo *info = device.find(ResourceKind::Framebuffer, command.id);
        if (!has_attachments || !info) {
          break;
        }
        for (const gpu::AttachedTexture &attached : std::get<gpu::FramebufferInfo>(info->desc).attachments) {
          const Resource texture{ResourceKind::Texture, attached.texture};
          const auto &desc = std::get<gpu::TextureDesc>(device.find(texture.first, texture.second)->desc);
          const bool is_depth = gpu::is_depth(desc.format);
          const bool is_kept = (is_depth ? actions.depth_load : actions.color_load) == gpu::LoadAction::Load;
          (is_kept ? reads_ : writes_).push_back(texture);
          attachments_.push_back({texture, is_depth ? gpu::State::WriteDepth : gpu::State::WriteColor});
        }
        break;
      }
      case gpu::CommandKind::SetState:
        for (const Attachment &attachment : attachments_) {
          if (has(gpu::State(command.first), attachment.write)) {
            writes_.push_back(attachment.texture);
          }
        }
        break;
      case gpu::CommandKind::BindTexture: reads_.emplace_back(ResourceKind::Texture, command.id); break;
      case gpu::CommandKind::BindUniform:
      case gpu::CommandKind::BindStorage: reads_.emplace_back(ResourceKind::Buffer, command.id); break;
      case gpu::CommandKind::Update: writes_.emplace_back(ResourceKind::Buffer, command.id); break;
      default: break;
    }
  }
}

void FrameCheck::check_bound(const FrameStep &step, const FrameState &state, const gpu::Device &device) const
{
  const auto is_bound = [&](const FrameRead &read) {
    return std::ranges::any_of(
        reads_, [&](const Resource &resource) { return device.name_of(resource.first, resource.second) == read.name; });
  };
  const auto is_group_bound = [&](std::string_view group) {
    return std::ranges::any_of(step.reads,
                               [&](const FrameRead &read) { return read.group == group && is_bound(read); });
  };
  for (const FrameRead &read : step.reads) {
    if (is_bound(read) || (read.when && !read.when(state)) || (!read.group.empty() && !is_group_bound(read.group))) {
      continue;
    }
    const bool is_there = std::ranges::any_of(written_, [&](const Resource &resource) {
      return device.find(resource.first, resource.second) &&
             device.name_of(resource.first, resource.second) == read.name;
    });
    GNOMON_ASSERT(!is_there, "step '{}' names '{}' as read, and its list does not bind it", step.name, read.name);
  }
}

void FrameCheck::check(const FrameStep &step, const FrameState &state, const gpu::CommandList &list,
                       const gpu::Device &device)
{
  // A host names the attachments of its target.
  collect(list, device, !is_named(step.writes, "target"));
  for (const auto &[kind, id] : writes_) {
    GNOMON_ASSERT(is_named(step.writes, device.name_of(kind, id)), "step '{}' writes {} '{}', which its list lacks",
                  step.name, gpu::to_string(kind), device.name_of(kind, id));
    const Resource resource(kind, id);
    if (const auto place = std::ranges::lower_bound(written_, resource);
        place == written_.end() || *place != resource) {
      written_.insert(place, resource);
    }
  }
  for (const auto &[kind, id] : reads_) {
    const std::string &name = device.name_of(kind, id);
    GNOMON_ASSERT(!std::ranges::binary_search(written_, Resource(kind, id)) || is_named(step.reads, name) ||
                      is_named(step.writes, name),
                  "step '{}' reads {} '{}', which its list lacks", step.name, gpu::to_string(kind), name);
  }
  const bool is_drawn = std::ranges::any_of(list.commands(), [](const gpu::Command &command) {
    return command.kind == gpu::CommandKind::Draw || command.kind == gpu::CommandKind::DrawProcedural;
  });
  if (is_drawn) {
    check_bound(step, state, device);
  }
}

}  // namespace gnomon::eevee
