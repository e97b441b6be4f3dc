// SPDX-License-Identifier: MIT
#include "gpu_device.hh"

#include "gpu_validate.hh"

#include <fmt/ranges.h>

#include <algorithm>
#include <bit>

namespace gnomon::gpu {

Device::Device(const Limits &limits, MessageSink sink, std::filesystem::path shader_cache_folder)
    : limits_(limits),
      sink_(std::move(sink)),
      shader_cache_(std::move(shader_cache_folder)),
      link_(std::make_shared<DeviceLink>(DeviceLink{this}))
{
  for (std::vector<Slot> &slots : slots_) {
    slots.emplace_back().info.name = "none";
  }
}

Device::~Device() = default;

void Device::free_live_resources()
{
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

void Device::message(std::string_view text) const
{
  if (sink_) {
    sink_(text);
  }
  else {
    fmt::print(stderr, "gnomon: {}\n", text);
  }
}

template <typename Create>
Resource Device::make(ResourceKind kind, ResourceInfo info, std::string detail, std::size_t size_bytes, Create &&create)
{
  std::vector<Slot> &slots = slots_[std::size_t(kind)];
  std::vector<ResourceId> &free_ids = free_ids_[std::size_t(kind)];
  if (free_ids.empty()) {
    if (slots.size() > resource_count_max) {
      throw Error("{} '{}': a device can hold at most {} of them", to_string(kind), info.name, resource_count_max);
    }
    free_ids.push_back(ResourceId(slots.size()));
    slots.emplace_back();
  }
  const ResourceId id = free_ids.back();
  perform({create(id)});
  slots_[std::size_t(kind)][index_of(id)] = {id, true, std::move(info), std::move(detail), size_bytes, 0};
  free_ids.pop_back();
  if (!recording_) {
    return {link_, kind, id};
  }
  InFlight &packet = in_flight_.back();
  if (!packet.link) {
    packet.link = std::make_shared<DeviceLink>(DeviceLink{this});
    packet_links_.push_back(packet.link);
  }
  packet.created.push_back({kind, id});
  return {packet.link, kind, id};
}

Texture Device::create_texture(const TextureDesc &desc)
{
  const auto in_range = [&](std::string_view what, int value, int max) {
    if (value < 1 || value > max) {
      throw Error("texture '{}': {} is {}, but this device supports 1 to {}", desc.name, what, value, max);
    }
  };
  const bool is_buffer = desc.kind == TextureKind::Buffer;
  in_range("width", desc.width, is_buffer ? limits_.buffer_texels_max : limits_.texture_size_max);
  in_range("height", desc.height, is_buffer ? 1 : limits_.texture_size_max);
  in_range("layer count", desc.layers, desc.kind == TextureKind::Array ? limits_.array_layers_max : 1);
  in_range("mip level count", desc.mip_levels,
           is_buffer ? 1 : int(std::bit_width(unsigned(std::max(desc.width, desc.height)))));
  GNOMON_ASSERT(!is_buffer || (!is_depth(desc.format) && desc.format != Format::SRGB8A8),
                "texture '{}' of texels in a buffer has the format {}", desc.name, to_string(desc.format));
  const std::string detail =
      fmt::format("{}x{}{} {}", desc.width, desc.height, desc.layers > 1 ? fmt::format("x{}", desc.layers) : "",
                  to_string(desc.format));
  Resource resource = make(ResourceKind::Texture, {desc.name, desc}, detail, desc.size_bytes(), [&](ResourceId id) {
    return Operation::CreateTexture{id, desc};
  });
  return {std::move(resource), desc};
}

Sampler Device::create_sampler(const SamplerDesc &desc)
{
  if (desc.anisotropy < 1 || desc.anisotropy > limits_.anisotropy_max) {
    throw Error("sampler '{}': anisotropy is {}, but this device supports 1 to {}", desc.name, desc.anisotropy,
                limits_.anisotropy_max);
  }
  const bool is_linear = desc.filter == Filter::Linear && desc.minified.value_or(desc.filter) == Filter::Linear;
  if (desc.anisotropy > 1 && (!is_linear || desc.mip == MipFilter::None)) {
    throw Error("sampler '{}': anisotropy is {}, which needs linear filters and mip levels", desc.name,
                desc.anisotropy);
  }
  return Sampler(make(ResourceKind::Sampler, {desc.name, desc}, {}, 0, [&](ResourceId id) {
    return Operation::CreateSampler{id, desc};
  }));
}

static AttachmentLayout layout_of(const Attachment &attachment)
{
  return {attachment.texture ? attachment.texture->id() : 0, attachment.layer, attachment.mip_level,
          attachment.layer_count};
}

Framebuffer Device::create_framebuffer(const FramebufferDesc &desc)
{
  if (int(desc.colors.size()) > limits_.color_attachment_max) {
    throw Error("framebuffer '{}': {} colour attachments, but this device supports {}", desc.name, desc.colors.size(),
                limits_.color_attachment_max);
  }
  std::vector<Attachment> attachments = desc.colors;
  if (desc.depth.texture) {
    attachments.push_back(desc.depth);
  }
  if (attachments.empty()) {
    throw Error("framebuffer '{}': it has no attachments", desc.name);
  }
  glm::ivec2 size_px{0};
  for (const Attachment &attachment : attachments) {
    GNOMON_ASSERT(attachment.texture && *attachment.texture, "framebuffer '{}'", desc.name);
    const TextureDesc &texture = attachment.texture->desc();
    GNOMON_ASSERT(texture.kind != TextureKind::Buffer, "framebuffer '{}': texture '{}' is a buffer", desc.name,
                  texture.name);
    const bool is_depth_attachment = &attachment == &attachments.back() && desc.depth.texture;
    if (is_depth(texture.format) != is_depth_attachment) {
      throw Error("framebuffer '{}': texture '{}' of format {} cannot be its {} attachment", desc.name, texture.name,
                  to_string(texture.format), is_depth_attachment ? "depth" : "colour");
    }
    if (attachment.layer < all_layers || attachment.layer >= texture.layers) {
      throw Error("framebuffer '{}': texture '{}' has no layer {}", desc.name, texture.name, attachment.layer);
    }
    if (attachment.layer_count < 1 || attachment.layer + attachment.layer_count > texture.layers ||
        (attachment.layer == all_layers && attachment.layer_count > 1)) {
      throw Error("framebuffer '{}': texture '{}' has no {} layers from {} on", desc.name, texture.name,
                  attachment.layer_count, attachment.layer);
    }
    if (attachment.mip_level < 0 || attachment.mip_level >= texture.mip_levels) {
      throw Error("framebuffer '{}': texture '{}' has no mip level {}", desc.name, texture.name, attachment.mip_level);
    }
    const glm::ivec2 size{std::max(texture.width >> attachment.mip_level, 1),
                          std::max(texture.height >> attachment.mip_level, 1)};
    if (size_px != glm::ivec2(0) && size != size_px) {
      throw Error("framebuffer '{}': texture '{}' is {}x{}, another attachment {}x{}", desc.name, texture.name, size.x,
                  size.y, size_px.x, size_px.y);
    }
    size_px = size;
  }
  FramebufferInfo info{.attachments = {}, .size_px = size_px};
  for (const Attachment &attachment : attachments) {
    info.attachments.push_back({attachment.texture->id(), attachment.texture->desc().name});
  }
  FramebufferLayout layout{desc.name, {}, layout_of(desc.depth), size_px};
  std::ranges::transform(desc.colors, std::back_inserter(layout.colors), layout_of);
  return {make(ResourceKind::Framebuffer, {desc.name, std::move(info)}, {}, 0,
               [&](ResourceId id) {
                 return Operation::CreateFramebuffer{id, layout};
               }),
          size_px};
}

Buffer Device::create_buffer(const BufferDesc &desc)
{
  const std::size_t max =
      desc.kind == BufferKind::Uniform ? limits_.uniform_block_bytes_max : limits_.storage_block_bytes_max;
  if (desc.size_bytes == 0 || desc.size_bytes > max) {
    throw Error("buffer '{}': {} bytes, but this device supports 1 to {}", desc.name, desc.size_bytes, max);
  }
  return {make(ResourceKind::Buffer, {desc.name, desc}, {}, desc.size_bytes,
               [&](ResourceId id) {
                 return Operation::CreateBuffer{id, desc};
               }),
          desc};
}

Batch Device::create_batch(const BatchDesc &desc)
{
  constexpr std::size_t count_max = std::size_t(1) << 28U;
  if (desc.positions.size() > count_max || desc.indices.size() > count_max) {
    throw Error("batch '{}': {} vertices and {} indices, but a batch can have at most {} of each", desc.name,
                desc.positions.size(), desc.indices.size(), count_max);
  }
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    const std::size_t stream_bytes = desc.bytes(VertexStream(i)).size();
    GNOMON_ASSERT(stream_bytes == 0 || stream_bytes == desc.positions.size() * vertex_formats()[i].size_bytes,
                  "batch '{}': {} bytes of attribute {} for {} positions", desc.name, stream_bytes,
                  vertex_formats()[i].attribute, desc.positions.size());
  }
  GNOMON_ASSERT(std::ranges::all_of(desc.indices, [&](auto index) { return index < desc.positions.size(); }),
                "batch '{}': an index reaches past its {} vertices", desc.name, desc.positions.size());
  const std::uint32_t vertex_capacity = vertices_.capacity();
  const std::uint32_t index_capacity = indices_.capacity();
  const BatchRange range = allocate_range(desc);
  try {
    Resource resource = make(ResourceKind::Batch, {desc.name, range}, {}, size_bytes(desc), [&](ResourceId id) {
      const BatchDesc data{.name = desc.name,
                           .positions = kept(desc.positions),
                           .normals = kept(desc.normals),
                           .indices = kept(desc.indices),
                           .uvs = kept(desc.uvs),
                           .second_uvs = kept(desc.second_uvs),
                           .tangents = kept(desc.tangents),
                           .colors = kept(desc.colors)};
      return Operation::CreateBatch{id, data, range, vertices_.capacity(), indices_.capacity()};
    });
    count_upload(ResourceKind::Batch, resource.id(), size_bytes(desc));
    return {std::move(resource), range};
  }
  catch (...) {
    free_range(range);
    // The backend may have failed to grow its buffers. Smaller batches still fit into the old capacity.
    vertices_.shrink(vertex_capacity);
    indices_.shrink(index_capacity);
    throw;
  }
}

BatchRange Device::allocate_range(const BatchDesc &desc)
{
  BatchRange range;
  const auto vertex_count = std::uint32_t(desc.positions.size());
  const auto index_count = std::uint32_t(desc.indices.size());
  try {
    range.base_vertex = std::int32_t(vertices_.allocate(vertex_count));
    range.vertex_count = vertex_count;
    range.first_index = indices_.allocate(index_count);
    range.index_count = index_count;
  }
  catch (const Error &error) {
    free_range(range);
    throw Error("batch '{}': {} vertices and {} indices: {}", desc.name, vertex_count, index_count, error.what());
  }
  return range;
}

void Device::free_range(const BatchRange &range)
{
  vertices_.free(std::uint32_t(range.base_vertex), range.vertex_count);
  indices_.free(range.first_index, range.index_count);
}

bool Device::has_batch_data(std::uint32_t first_index, std::uint32_t index_count, std::int32_t base_vertex) const
{
  return base_vertex >= 0 && vertices_.is_allocated(std::uint32_t(base_vertex), 1) &&
         indices_.is_allocated(first_index, index_count);
}

static void check_storage_blocks(std::string_view name, const ShaderInterface &interface, const Limits &limits)
{
  for (const auto &[stage, max] : {std::pair(ShaderStage::Vertex, limits.vertex_storage_block_max),
                                   std::pair(ShaderStage::Geometry, limits.geometry_storage_block_max),
                                   std::pair(ShaderStage::Fragment, limits.fragment_storage_block_max)}) {
    const auto count = std::ranges::count_if(interface.bindings, [&](const ShaderInterface::Binding &binding) {
      return binding.kind == BindingKind::StorageBlock && (binding.stages & (1U << unsigned(stage))) != 0;
    });
    if (count > max) {
      throw Error("shader '{}': {} storage blocks in the {} stage, but this device supports {}", name, count,
                  to_string(stage), max);
    }
  }
}

Shader Device::create_shader(const ShaderDesc &desc, const ShaderFiles &files, const ShaderReflection &reflection,
                             const ShaderFiles &stand_in)
{
  std::vector<ShaderSource> stages = preprocess(desc, files);
  std::vector<ShaderSource> stand_in_stages = stand_in ? preprocess(desc, stand_in) : std::vector<ShaderSource>();
  ShaderInterface interface = reflection(desc.name, stages);
  check_storage_blocks(desc.name, interface, limits_);
  const std::string detail = fmt::format("{}", fmt::join(desc.defines, " "));
  Resource resource = make(ResourceKind::Shader, {desc.name, interface}, detail, 0, [&](ResourceId id) {
    std::vector<std::string> samplers;
    for (const ShaderInterface::Binding &binding : interface.bindings) {
      if (binding.kind == BindingKind::Texture) {
        samplers.push_back(binding.name);
      }
    }
    return Operation::CreateShader{id, desc, std::move(stages), std::move(samplers), std::move(stand_in_stages)};
  });
  return {std::move(resource), desc.name, std::move(interface)};
}

TimerQuery Device::create_timer_query(std::string name)
{
  return TimerQuery(make(ResourceKind::TimerQuery, {name, {}}, {}, 0, [&](ResourceId id) {
    return Operation::CreateTimerQuery{id, name};
  }));
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

void Device::upload(const Texture &texture, int layer, std::span<const std::byte> texels)
{
  const TextureDesc &desc = texture.desc();
  const bool has_size = desc.kind == TextureKind::Buffer ? texels.size() <= layer_size_bytes(desc)
                                                         : texels.size() == layer_size_bytes(desc);
  GNOMON_ASSERT(texture && layer >= 0 && layer < desc.layers && has_size, "texture '{}': {} bytes to layer {}",
                desc.name, texels.size(), layer);
  perform({Operation::UploadTexture{texture.id(), layer, kept(texels)}});
  count_upload(ResourceKind::Texture, texture.id(), texels.size());
}

void Device::generate_mipmaps(const Texture &texture)
{
  GNOMON_ASSERT(texture && !is_depth(texture.desc().format) && texture.desc().kind != TextureKind::Buffer,
                "texture '{}' of format {}", texture.desc().name, to_string(texture.desc().format));
  perform({Operation::GenerateMipmaps{texture.id()}});
}

void Device::copy_layers(const Texture &source, const Texture &target)
{
  GNOMON_ASSERT(source && target && source.id() != target.id() && source.desc().format == target.desc().format &&
                    source.desc().kind == target.desc().kind && source.desc().kind != TextureKind::Buffer,
                "copy of texture '{}' to '{}'", source.desc().name, target.desc().name);
  const TextureDesc &from = source.desc();
  const TextureDesc &to = target.desc();
  perform({Operation::CopyLayers{source.id(),
                                 target.id(),
                                 {std::min(from.width, to.width), std::min(from.height, to.height)},
                                 std::min(from.layers, to.layers)}});
}

std::vector<std::byte> Device::read(const Texture &texture, int layer)
{
  const TextureDesc &desc = texture.desc();
  GNOMON_ASSERT(std::this_thread::get_id() == thread_, "texture '{}' is read on another thread than the device's",
                desc.name);
  GNOMON_ASSERT(!recording_, "a read of texture '{}' during a recording", desc.name);
  GNOMON_ASSERT(texture && layer >= 0 && layer < desc.layers, "texture '{}' has no layer {}", desc.name, layer);
  std::vector<std::byte> texels(layer_size_bytes(desc));
  texture_read(texture.id(), layer, texels);
  return texels;
}

void Device::read_back(const Texture &texture, int layer, std::uint64_t tag)
{
  const TextureDesc &desc = texture.desc();
  GNOMON_ASSERT(recording_, "a recorded read of texture '{}' outside of a recording", desc.name);
  GNOMON_ASSERT(texture && layer >= 0 && layer < desc.layers, "texture '{}' has no layer {}", desc.name, layer);
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

std::vector<LiveResource> Device::live() const
{
  std::vector<LiveResource> resources;
  for (std::size_t kind = 0; kind < kind_count; kind++) {
    for (const Slot &slot : slots_[kind]) {
      if (slot.is_live) {
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
