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

void FrameCheck::check(const FrameStep &step, const gpu::CommandList &list, const gpu::Device &device)
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
}

}  // namespace gnomon::eevee
