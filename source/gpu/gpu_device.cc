// SPDX-License-Identifier: MIT
#include "gpu_device.hh"

#include "gpu_range_allocator.hh"
#include "gpu_shader_cache.hh"
#include "gpu_validate.hh"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace gnomon::gpu {

Device::Device(const Limits &limits, MessageSink sink, std::filesystem::path shader_cache_folder)
    : limits_(limits),
      sink_(std::move(sink)),
      shader_cache_(std::make_unique<ShaderDiskCache>(std::move(shader_cache_folder))),
      link_(std::make_shared<DeviceLink>(DeviceLink{this})),
      vertices_(std::make_unique<RangeAllocator>()),
      indices_(std::make_unique<RangeAllocator>())
{
  for (std::vector<Slot> &slots : slots_) {
    slots.emplace_back().info.name = "none";
  }
}

Device::~Device() = default;

void Device::free_live_resources()
{
  trim_shared_shaders(0);
  for (const std::string &resource : live_resources()) {
    message(fmt::format("{} is destroyed with its device; its owner should be destroyed first", resource));
  }
  for (std::size_t kind = 0; kind < kind_count; kind++) {
    for (const ResourceId id : existing_[kind]) {
      destroy(ResourceKind(kind), id);
    }
  }
  link_->device = nullptr;
  for (const std::shared_ptr<DeviceLink> &link : packet_links_) {
    link->device = nullptr;
  }
}

void send_message(const MessageSink &sink, std::string_view text)
{
  if (sink) {
    sink(text);
  }
  else {
    fmt::print(stderr, "gnomon: {}\n", text);
  }
}

void Device::message(std::string_view text) const
{
  send_message(sink_, text);
}

void Device::update(const Buffer &buffer, std::size_t offset_bytes, std::span<const std::byte> bytes)
{
  GNOMON_ASSERT(buffer && offset_bytes + bytes.size() <= buffer.size_bytes(),
                "buffer '{}': {} bytes at {} do not fit into {}", name_of(ResourceKind::Buffer, buffer.id()),
                bytes.size(), offset_bytes, buffer.size_bytes());
  perform({Operation::UpdateBuffer{buffer.id(), offset_bytes, kept(bytes)}});
  count_upload(ResourceKind::Buffer, buffer.id(), bytes.size());
}

static std::size_t layer_size_bytes(const TextureDesc &desc)
{
  return std::size_t(desc.width) * std::size_t(desc.height) * std::size_t(texel_size_bytes(desc.format));
}

static std::size_t level_sizes_bytes(const TextureDesc &desc)
{
  std::size_t size = 0;
  for (int level = 0; level < desc.mip_levels; level++) {
    size += std::size_t(std::max(desc.width >> level, 1)) * std::size_t(std::max(desc.height >> level, 1)) *
            std::size_t(texel_size_bytes(desc.format));
  }
  return size;
}

void Device::upload(const Texture &texture, int layer, std::span<const std::byte> texels)
{
  const TextureDesc &desc = texture.desc();
  const bool has_all_levels = desc.kind == TextureKind::Flat && texels.size() == level_sizes_bytes(desc);
  const bool has_size = desc.kind == TextureKind::Buffer ? texels.size() <= layer_size_bytes(desc)
                                                         : texels.size() == layer_size_bytes(desc) || has_all_levels;
  GNOMON_ASSERT(texture && desc.format != Format::Host && layer >= 0 && layer < desc.layers && has_size,
                "texture '{}' of format {}: {} bytes to layer {}", desc.name, to_string(desc.format), texels.size(),
                layer);
  perform({Operation::UploadTexture{texture.id(), layer, kept(texels)}});
  count_upload(ResourceKind::Texture, texture.id(), texels.size());
}

void Device::generate_mipmaps(const Texture &texture)
{
  GNOMON_ASSERT(texture && !is_depth(texture.desc().format) && texture.desc().format != Format::Host &&
                    texture.desc().kind != TextureKind::Buffer,
                "texture '{}' of format {}", texture.desc().name, to_string(texture.desc().format));
  perform({Operation::GenerateMipmaps{texture.id()}});
}

void Device::copy_layers(const Texture &source, const Texture &target)
{
  GNOMON_ASSERT(source && target && source.id() != target.id() && source.desc().format == target.desc().format &&
                    source.desc().format != Format::Host && source.desc().kind == target.desc().kind &&
                    source.desc().kind != TextureKind::Buffer,
                "copy of texture '{}' to '{}'", source.desc().name, target.desc().name);
  const TextureDesc &from = source.desc();
  const TextureDesc &to = target.desc();
  perform({Operation::CopyLayers{source.id(),
                                 target.id(),
                                 {std::min(from.width, to.width), std::min(from.height, to.height)},
                                 std::min(from.layers, to.layers)}});
}

void Device::begin_image(const Framebuffer &framebuffer, int layout, const HostSemaphore &wait)
{
  GNOMON_ASSERT(framebuffer, "an empty framebuffer");
  perform({Operation::TakeImage{framebuffer.id(), layout, wait, false}});
}

void Device::end_image(const Framebuffer &framebuffer, int layout, const HostSemaphore &signal)
{
  GNOMON_ASSERT(framebuffer, "an empty framebuffer");
  perform({Operation::TakeImage{framebuffer.id(), layout, signal, true}});
}

void Device::host_framebuffer_create(ResourceId /*id*/, const std::string &name, const HostImage & /*image*/)
{
  throw Error("framebuffer '{}': only a device of Vulkan draws into images of the host", name);
}

std::vector<std::byte> Device::read(const Texture &texture, int layer)
{
  const TextureDesc &desc = texture.desc();
  GNOMON_ASSERT(std::this_thread::get_id() == thread_, "texture '{}' is read on another thread than the device's",
                desc.name);
  GNOMON_ASSERT(!recording_, "a read of texture '{}' during a recording", desc.name);
  GNOMON_ASSERT(texture && desc.format != Format::Host && layer >= 0 && layer < desc.layers,
                "texture '{}' of format {} has no layer {}", desc.name, to_string(desc.format), layer);
  check_can_execute();
  std::vector<std::byte> texels(layer_size_bytes(desc));
  texture_read(texture.id(), layer, texels);
  return texels;
}

void Device::read_back(const Texture &texture, int layer, std::uint64_t tag)
{
  const TextureDesc &desc = texture.desc();
  GNOMON_ASSERT(recording_, "a recorded read of texture '{}' outside of a recording", desc.name);
  GNOMON_ASSERT(texture && desc.format != Format::Host && layer >= 0 && layer < desc.layers,
                "texture '{}' of format {} has no layer {}", desc.name, to_string(desc.format), layer);
  perform({Operation::ReadBack{texture.id(), layer, layer_size_bytes(desc), tag}});
}

void Device::time_begin(const TimerQuery &query)
{
  perform({Operation::MarkTime{query.id(), false}});
}

void Device::time_end(const TimerQuery &query)
{
  perform({Operation::MarkTime{query.id(), true}});
}

void Device::submit(const CommandList &list)
{
#ifndef NDEBUG
  validate(list, *this);
#endif
  if (recording_) {
    perform({Operation::SubmitList{recording_->index_of(list)}});
  }
  else {
    submit_now(list);
  }
  count_uploads(list);
}

CommandList &Device::add_list()
{
  GNOMON_ASSERT(recording_, "a list of a packet outside of a recording");
  return recording_->add_list();
}

void Device::count_upload(ResourceKind kind, ResourceId id, std::size_t bytes)
{
  slots_[std::size_t(kind)][index_of(id)].upload_bytes += bytes;
}

void Device::count_uploads(const CommandList &list)
{
  for (const Command &command : list.commands()) {
    if (command.kind == CommandKind::Update) {
      count_upload(ResourceKind::Buffer, command.id, command.count);
    }
  }
}

const Device::Slot &Device::slot_of(ResourceKind kind, ResourceId id) const
{
  const std::vector<Slot> &slots = slots_[std::size_t(kind)];
  const std::uint32_t index = index_of(id);
  return index < slots.size() && slots[index].id == id ? slots[index] : slots[0];
}

const std::string &Device::name_of(ResourceKind kind, ResourceId id) const
{
  return slot_of(kind, id).info.name;
}

const ResourceInfo *Device::find(ResourceKind kind, ResourceId id) const
{
  const Slot &slot = slot_of(kind, id);
  return slot.is_live ? &slot.info : nullptr;
}

bool Device::has_batch_data(std::uint32_t first_index, std::uint32_t index_count, std::int32_t base_vertex) const
{
  return base_vertex >= 0 && vertices_->is_allocated(std::uint32_t(base_vertex), 1) &&
         indices_->is_allocated(first_index, index_count);
}

std::vector<LiveResource> Device::live() const
{
  std::set<ResourceId> unused_shaders;
  for (const auto &[key, kept] : shared_shaders_) {
    if (kept.shared.use_count() == 1) {
      unused_shaders.insert(kept.shared->shader.id());
    }
  }
  std::vector<LiveResource> resources;
  for (std::size_t kind = 0; kind < kind_count; kind++) {
    for (const Slot &slot : slots_[kind]) {
      const bool is_unused = ResourceKind(kind) == ResourceKind::Shader && unused_shaders.contains(slot.id);
      if (slot.is_live && !is_unused) {
        resources.push_back({ResourceKind(kind), slot.info.name, slot.detail, slot.size_bytes, slot.upload_bytes});
      }
    }
  }
  return resources;
}

LiveResource Device::live(const Resource &resource) const
{
  GNOMON_ASSERT(resource, "an empty {}", to_string(resource.kind_));
  const Slot &slot = slot_of(resource.kind_, resource.id());
  return {resource.kind_, slot.info.name, slot.detail, slot.size_bytes, slot.upload_bytes};
}

std::vector<std::string> Device::live_resources() const
{
  std::vector<std::string> names;
  for (const LiveResource &resource : live()) {
    names.push_back(fmt::format("{} '{}'", to_string(resource.kind), resource.name));
  }
  return names;
}

std::size_t Device::memory_bytes() const
{
  std::size_t bytes = 0;
  for (const LiveResource &resource : live()) {
    bytes += resource.size_bytes;
  }
  return bytes;
}

}  // namespace gnomon::gpu
