// SPDX-License-Identifier: MIT
#include "eevee_frame_check.hh"

#include "eevee_frame.hh"

#include "gpu_device.hh"

#include <algorithm>
#include <vector>

namespace gnomon::eevee {

namespace {

using gpu::ResourceKind;

bool is_named(const std::vector<std::string_view> &names, std::string_view name)
{
  return std::ranges::find(names, name) != names.end();
}

/** Textures and buffers that a list reads and writes. */
struct Used {
  std::set<std::pair<ResourceKind, gpu::ResourceId>> reads;
  std::set<std::pair<ResourceKind, gpu::ResourceId>> writes;
};

/** \a has_attachments: whether attachments count. They are written if they are drawn or cleared, and otherwise read. */
Used used_by(const gpu::CommandList &list, const gpu::Device &device, bool has_attachments)
{
  Used used;
  /** Attachments of the current pass, and the state that writes each. */
  std::vector<std::pair<gpu::ResourceId, gpu::State>> attachments;
  for (const gpu::Command &command : list.commands()) {
    switch (command.kind) {
      case gpu::CommandKind::BeginPass: {
        attachments.clear();
        const gpu::PassActions &actions = list.passes()[command.first].actions;
        const gpu::ResourceInfo *info = device.find(ResourceKind::Framebuffer, command.id);
        if (!has_attachments || !info) {
          break;
        }
        for (const gpu::AttachedTexture &attached : std::get<gpu::FramebufferInfo>(info->desc).attachments) {
          const gpu::ResourceInfo &texture = *device.find(ResourceKind::Texture, attached.texture);
          const bool is_depth = gpu::is_depth(std::get<gpu::TextureDesc>(texture.desc).format);
          const bool is_kept = (is_depth ? actions.depth_load : actions.color_load) == gpu::LoadAction::Load;
          (is_kept ? used.reads : used.writes).emplace(ResourceKind::Texture, attached.texture);
          attachments.emplace_back(attached.texture, is_depth ? gpu::State::WriteDepth : gpu::State::WriteColor);
        }
        break;
      }
      case gpu::CommandKind::SetState:
        for (const auto &[texture, write] : attachments) {
          if (has(gpu::State(command.first), write)) {
            used.writes.emplace(ResourceKind::Texture, texture);
          }
        }
        break;
      case gpu::CommandKind::BindTexture: used.reads.emplace(ResourceKind::Texture, command.id); break;
      case gpu::CommandKind::BindUniform:
      case gpu::CommandKind::BindStorage: used.reads.emplace(ResourceKind::Buffer, command.id); break;
      case gpu::CommandKind::Update: used.writes.emplace(ResourceKind::Buffer, command.id); break;
      default: break;
    }
  }
  return used;
}

}  // namespace

void FrameCheck::check(const FrameStep &step, const gpu::CommandList &list, const gpu::Device &device)
{
  // A host names the attachments of its target.
  const Used used = used_by(list, device, !is_named(step.writes, "target"));
  for (const auto &[kind, id] : used.writes) {
    GNOMON_ASSERT(is_named(step.writes, device.name_of(kind, id)), "step '{}' writes {} '{}', which its list lacks",
                  step.name, gpu::to_string(kind), device.name_of(kind, id));
    written_.emplace(kind, id);
  }
  for (const auto &[kind, id] : used.reads) {
    const std::string &name = device.name_of(kind, id);
    GNOMON_ASSERT(!written_.contains({kind, id}) || is_named(step.reads, name) || is_named(step.writes, name),
                  "step '{}' reads {} '{}', which its list lacks", step.name, gpu::to_string(kind), name);
  }
}

}  // namespace gnomon::eevee
