// SPDX-License-Identifier: MIT
#include "vulkan_device.hh"

#include "trace.hh"

#include <fmt/ranges.h>

#include <algorithm>
#include <cstring>
#include <numeric>

namespace gnomon::gpu {

namespace {

VkSamplerAddressMode vulkan_wrap(Wrap wrap)
{
  switch (wrap) {
    case Wrap::ClampToEdge: return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    case Wrap::Repeat: return VK_SAMPLER_ADDRESS_MODE_REPEAT;
    case Wrap::MirroredRepeat: return VK_SAMPLER_ADDRESS_MODE_MIRRORED_REPEAT;
  }
  return VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
}

VkFilter vulkan_filter(Filter filter)
{
  return filter == Filter::Linear ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
}

/** A copy of all texels of one mip level of one layer. */
VkBufferImageCopy region_of(const VulkanImage &image, VkDeviceSize offset_bytes, std::uint32_t level, int layer)
{
  VkBufferImageCopy region{};
  region.bufferOffset = offset_bytes;
  region.imageSubresource = {image.aspect, level, std::uint32_t(layer), 1};
  region.imageExtent = extent_of(image, level);
  return region;
}

/** Whether draws choose the layer of the attachment. */
bool is_layered(const TextureDesc &desc, const AttachmentLayout &layout)
{
  return desc.kind == TextureKind::Array && (layout.layer == all_layers || layout.layer_count > 1);
}

/** Alignment of texels in buffers, bytes: a multiple of each texel's size, and of four. */
constexpr VkDeviceSize texel_alignment = 16;

/** Largest total of uploads that the device has not finished, bytes. */
constexpr VkDeviceSize stream_bytes_max = VkDeviceSize(128) << 20U;

}  // namespace

void VulkanDevice::texture_create(ResourceId id, const TextureDesc &desc)
{
  const trace::Span span("create texture", desc.name);
  const std::string what = fmt::format("texture '{}'", desc.name);
  VulkanTexture texture;
  texture.desc = desc;
  if (desc.format == Format::Host) {
    texture.image = make_host_image(what, desc);
  }
  else if (desc.kind == TextureKind::Buffer) {
    texture.buffer = memory_.make_buffer(
        what, desc.size_bytes(),
        VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
        MemoryUse::Device);
    context_->label(VK_OBJECT_TYPE_BUFFER, texture.buffer.handle, desc.name);
    VkBufferViewCreateInfo view{};
    view.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO;
    view.buffer = texture.buffer.handle;
    view.format = vulkan_format(desc.format);
    view.range = desc.size_bytes();
    const VkResult result = context_->vk.vkCreateBufferView(context_->device, &view, nullptr, &texture.buffer_view);
    if (result != VK_SUCCESS) {
      memory_.destroy(texture.buffer);
      context_->check(result, what);
    }
    context_->label(VK_OBJECT_TYPE_BUFFER_VIEW, texture.buffer_view, desc.name);
  }
  else {
    texture.image = make_image(*context_, memory_, what, desc, vulkan_format(desc.format));
  }
  textures_.insert(id, std::move(texture));
  check_made(ResourceKind::Texture, id, what);
}

void VulkanDevice::check_host(std::string_view what, std::string_view whats) const
{
  if (!context_->is_host()) {
    throw Error("{}: the host's {} are on another VkDevice than this device, which has one of its own", what, whats);
  }
}

VulkanImage VulkanDevice::make_host_image(std::string_view what, const TextureDesc &desc)
{
  check_host(what, "images");
  VulkanImage image;
  image.handle = VkImage(std::uintptr_t(desc.host.name));
  image.format = VkFormat(desc.host.format);
  VkFormatProperties properties{};
  context_->instance.vkGetPhysicalDeviceFormatProperties(context_->physical_device, image.format, &properties);
  constexpr VkFormatFeatureFlags needed =
      VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
  const bool is_depth = (properties.optimalTilingFeatures & VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT) != 0;
  if ((properties.optimalTilingFeatures & needed) != needed || is_depth) {
    throw Error("{}: the device cannot look up and filter colours in VkFormat {} of the host's image", what,
                desc.host.format);
  }
  constexpr std::array<VkImageLayout, 3> layouts = {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                                                    VK_IMAGE_LAYOUT_READ_ONLY_OPTIMAL, VK_IMAGE_LAYOUT_GENERAL};
  if (std::ranges::find(layouts, VkImageLayout(desc.host.layout)) == layouts.end()) {
    throw Error("{}: no image of the host can be looked up in VkImageLayout {}", what, desc.host.layout);
  }
  image.size_px = {desc.width, desc.height};
  image.levels = std::uint32_t(desc.mip_levels);
  image.view = make_view(*context_, what, image, image.format, VK_IMAGE_VIEW_TYPE_2D,
                         {VK_IMAGE_ASPECT_COLOR_BIT, 0, image.levels, 0, 1});
  // The host owns the image: only the view is destroyed.
  image.handle = VK_NULL_HANDLE;
  return image;
}

VkSampler VulkanDevice::make_sampler(std::string_view what, const VkSamplerCreateInfo &info)
{
  VkSampler sampler = VK_NULL_HANDLE;
  context_->check(context_->vk.vkCreateSampler(context_->device, &info, nullptr, &sampler), what);
  context_->label(VK_OBJECT_TYPE_SAMPLER, sampler, std::string(what));
  return sampler;
}

void VulkanDevice::sampler_create(ResourceId id, const SamplerDesc &desc)
{
  const std::string what = fmt::format("sampler '{}'", desc.name);
  VkSamplerCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
  info.magFilter = vulkan_filter(desc.filter);
  info.minFilter = vulkan_filter(desc.minified.value_or(desc.filter));
  info.mipmapMode = desc.mip == MipFilter::Linear ? VK_SAMPLER_MIPMAP_MODE_LINEAR : VK_SAMPLER_MIPMAP_MODE_NEAREST;
  info.addressModeU = vulkan_wrap(desc.wrap_u);
  info.addressModeV = vulkan_wrap(desc.wrap_v);
  info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
  info.anisotropyEnable = desc.anisotropy > 1 ? VK_TRUE : VK_FALSE;
  info.maxAnisotropy = float(desc.anisotropy);
  info.compareEnable = desc.is_depth_comparison ? VK_TRUE : VK_FALSE;
  info.compareOp = VK_COMPARE_OP_GREATER_OR_EQUAL;
  // Below 0.5, the nearest level is 0, and the filter still depends on whether the texture is minified.
  constexpr float only_level_zero = 0.25F;
  info.maxLod = desc.mip == MipFilter::None ? only_level_zero : VK_LOD_CLAMP_NONE;
  samplers_.insert(id, make_sampler(what, info));
  check_made(ResourceKind::Sampler, id, what);
}

VulkanDevice::VulkanAttachment VulkanDevice::make_attachment(std::string_view what, const AttachmentLayout &layout)
{
  const VulkanTexture &texture = textures_.at(layout.texture);
  const VulkanImage &image = texture.image;
  const bool is_all = layout.layer == all_layers;
  VulkanAttachment attachment;
  attachment.texture = layout.texture;
  attachment.layers = is_all ? image.layers : std::uint32_t(layout.layer_count);
  const VkImageSubresourceRange range{image.aspect, std::uint32_t(layout.mip_level), 1,
                                      is_all ? 0 : std::uint32_t(layout.layer), attachment.layers};
  const VkImageViewType type = is_layered(texture.desc, layout) ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D;
  attachment.formats = {unencoded(image.format), image.format};
  try {
    attachment.views[0] = make_view(*context_, what, image, attachment.formats[0], type, range);
    attachment.views[1] = attachment.formats[1] == attachment.formats[0]
                              ? attachment.views[0]
                              : make_view(*context_, what, image, attachment.formats[1], type, range);
  }
  catch (...) {
    destroy_attachment(attachment);
    throw;
  }
  return attachment;
}

void VulkanDevice::destroy_attachment(const VulkanAttachment &attachment)
{
  context_->vk.vkDestroyImageView(context_->device, attachment.views[0], nullptr);
  if (attachment.views[1] != attachment.views[0]) {
    context_->vk.vkDestroyImageView(context_->device, attachment.views[1], nullptr);
  }
}

void VulkanDevice::framebuffer_create(ResourceId id, const FramebufferLayout &layout)
{
  const std::string what = fmt::format("framebuffer '{}'", layout.name);
  VulkanFramebuffer framebuffer;
  framebuffer.size_px = layout.size_px;
  std::optional<bool> has_layers;
  try {
    const auto make = [&](const AttachmentLayout &attachment) {
      const bool has = is_layered(textures_.at(attachment.texture).desc, attachment);
      if (has_layers.value_or(has) != has) {
        throw Error("{}: some of its attachments have layers, and others are one layer", what);
      }
      VulkanAttachment made = make_attachment(what, attachment);
      framebuffer.layer_count = has_layers ? std::min(framebuffer.layer_count, made.layers) : made.layers;
      has_layers = has;
      return made;
    };
    for (const AttachmentLayout &color : layout.colors) {
      framebuffer.colors.push_back(make(color));
    }
    if (layout.depth.texture != 0) {
      framebuffer.depth = make(layout.depth);
    }
    if (framebuffer.layer_count > context_->limits.maxFramebufferLayers) {
      throw Error("{}: {} layers, but this device draws into at most {} at once", what, framebuffer.layer_count,
                  context_->limits.maxFramebufferLayers);
    }
  }
  catch (...) {
    destroy_framebuffer(framebuffer);
    throw;
  }
  framebuffers_.insert(id, std::move(framebuffer));
  check_made(ResourceKind::Framebuffer, id, what);
}

void VulkanDevice::host_framebuffer_create(ResourceId id, const std::string &name, const HostImage &image)
{
  const std::string what = fmt::format("framebuffer '{}' of the host's image", name);
  const auto format = VkFormat(image.format);
  const bool is_turned = image.rows == RowOrder::TopFirst;
  VkFormatProperties properties{};
  context_->instance.vkGetPhysicalDeviceFormatProperties(context_->physical_device, format, &properties);
  const VkFormatFeatureFlags needed =
      VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT | VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BLEND_BIT |
      (is_turned ? VK_FORMAT_FEATURE_BLIT_SRC_BIT | VK_FORMAT_FEATURE_BLIT_DST_BIT : 0U);
  if ((properties.optimalTilingFeatures & needed) != needed) {
    throw Error("{}: the device cannot draw into VkFormat {}", what, image.format);
  }
  VulkanFramebuffer framebuffer;
  framebuffer.size_px = image.size_px;
  framebuffer.name = name;
  VulkanHostImage &host = *(framebuffer.host = std::make_shared<VulkanHostImage>());
  host.image.handle = image.image;
  host.image.format = format;
  host.image.size_px = image.size_px;
  host.samples = VkSampleCountFlagBits(image.samples);
  if (is_turned) {
    const TextureDesc desc{.name = name, .width = image.size_px.x, .height = image.size_px.y};
    host.turned = make_image(*context_, memory_, what, desc, format);
  }
  VulkanAttachment &color = framebuffer.colors.emplace_back();
  // A host's image has no views of other formats than its own.
  color.formats = {is_turned ? unencoded(format) : format, format};
  const VkImageSubresourceRange range{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  try {
    color.views[0] = make_view(*context_, what, host.drawn(), color.formats[0], VK_IMAGE_VIEW_TYPE_2D, range);
    color.views[1] = color.formats[1] == color.formats[0]
                         ? color.views[0]
                         : make_view(*context_, what, host.drawn(), format, VK_IMAGE_VIEW_TYPE_2D, range);
  }
  catch (...) {
    destroy_framebuffer(framebuffer);
    throw;
  }
  framebuffers_.insert(id, std::move(framebuffer));
  check_made(ResourceKind::Framebuffer, id, what);
}

void VulkanDevice::destroy_framebuffer(const VulkanFramebuffer &framebuffer)
{
  for (const VulkanAttachment &color : framebuffer.colors) {
    destroy_attachment(color);
  }
  if (framebuffer.depth) {
    destroy_attachment(*framebuffer.depth);
  }
  if (framebuffer.host && framebuffer.host->turned) {
    destroy_image(*context_, memory_, *framebuffer.host->turned);
  }
}

void VulkanDevice::turn(VulkanImage &from, VulkanImage &to)
{
  VkCommandBuffer commands = submissions_.commands();
  barriers_.before_use(from, use::copied_from);
  barriers_.before_use(to, use::copied_to);
  barriers_.record(commands);
  const VkImageSubresourceLayers layers{VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  const auto [width, height] = std::pair(from.size_px.x, from.size_px.y);
  const VkImageBlit blit{layers, {{0, height, 0}, {width, 0, 1}}, layers, {{0, 0, 0}, {width, height, 1}}};
  context_->vk.vkCmdBlitImage(commands, from.handle, from.last_use.layout, to.handle, to.last_use.layout, 1, &blit,
                              VK_FILTER_NEAREST);
}

void VulkanDevice::image_take(const Operation::TakeImage &take)
{
  VulkanFramebuffer &framebuffer = framebuffers_.at(take.framebuffer);
  const std::string what = fmt::format("framebuffer '{}'", framebuffer.name);
  if (!framebuffer.host) {
    throw Error("{}: it has no image of the host", what);
  }
  VulkanHostImage &host = *framebuffer.host;
  if (host.is_taken != take.is_end) {
    throw Error("{}: begin_image and end_image do not alternate", what);
  }
  const auto layout = VkImageLayout(take.layout);
  if (take.is_end) {
    if (layout == VK_IMAGE_LAYOUT_UNDEFINED || layout == VK_IMAGE_LAYOUT_PREINITIALIZED) {
      throw Error("{}: no image can be given back in VkImageLayout {}", what, take.layout);
    }
    if (host.turned) {
      turn(*host.turned, host.image);
    }
    barriers_.before_use(host.image, use::by_host(layout));
    barriers_.record(submissions_.commands());
    submissions_.signal(take.semaphore);
    host.is_taken = false;
    submissions_.flush();
  }
  else {
    host.image.last_use = use::by_host(layout);
    submissions_.wait_for(take.semaphore);
    host.is_taken = true;
    if (host.turned && layout != VK_IMAGE_LAYOUT_UNDEFINED) {
      turn(host.image, *host.turned);
    }
  }
  check(what);
}

void VulkanDevice::buffer_create(ResourceId id, const BufferDesc &desc)
{
  const trace::Span span("create buffer", desc.name);
  const std::string what = fmt::format("buffer '{}'", desc.name);
  // A storage buffer may be bound to uniform blocks, and be the objects of instances.
  const VkBufferUsageFlags usage =
      VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
      (desc.kind == BufferKind::Storage ? VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_VERTEX_BUFFER_BIT : 0);
  buffers_.insert(id, memory_.make_buffer(what, desc.size_bytes, usage, MemoryUse::Device));
  context_->label(VK_OBJECT_TYPE_BUFFER, buffers_.at(id).handle, desc.name);
  check_made(ResourceKind::Buffer, id, what);
}

void VulkanDevice::grow_pools(const BatchDesc &desc, const PoolSizes &sizes)
{
  const std::string what =
      fmt::format("batch '{}': {} bytes of vertices and {} of indices in all", desc.name,
                  std::reduce(sizes.begin(), sizes.begin() + vertex_stream_count), sizes[index_pool]);
  VkCommandBuffer commands = submissions_.commands();
  Pools grown{};
  try {
    for (std::size_t i = 0; i < pool_count; i++) {
      if (sizes[i] > pools_[i].size_bytes) {
        const VkBufferUsageFlags usage =
            i == index_pool ? VK_BUFFER_USAGE_INDEX_BUFFER_BIT : VK_BUFFER_USAGE_VERTEX_BUFFER_BIT;
        grown[i] = memory_.make_buffer(what, sizes[i],
                                       usage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                       MemoryUse::Device);
      }
    }
  }
  catch (...) {
    for (const VulkanBuffer &buffer : grown) {
      memory_.destroy(buffer);
    }
    throw;
  }
  for (std::size_t i = 0; i < pool_count; i++) {
    if (grown[i].handle == VK_NULL_HANDLE) {
      continue;
    }
    context_->label(VK_OBJECT_TYPE_BUFFER, grown[i].handle,
                    i == index_pool ? "indices" : std::string(to_string(VertexStream(i))));
    const VulkanBuffer old = std::exchange(pools_[i], grown[i]);
    if (old.handle != VK_NULL_HANDLE) {
      barriers_.before_copy(old.handle, {pools_[i].handle, 0, old.size_bytes});
      barriers_.record(commands);
      const VkBufferCopy region{0, 0, old.size_bytes};
      context_->vk.vkCmdCopyBuffer(commands, old.handle, pools_[i].handle, 1, &region);
      submissions_.retire([this, old] { memory_.destroy(old); });
    }
  }
}

void VulkanDevice::batch_create(const BatchDesc &desc, const BatchRange &range, std::uint32_t vertex_capacity,
                                std::uint32_t index_capacity)
{
  const trace::Span span("create batch", desc.name);
  // The pool of a stream is created for the first batch with that stream. Only batches with the stream grow it.
  PoolSizes sizes{};
  std::ranges::transform(pools_, sizes.begin(), &VulkanBuffer::size_bytes);
  const PoolSizes before = sizes;
  const auto need = [&sizes](std::size_t pool, VkDeviceSize bytes) { sizes[pool] = std::max(sizes[pool], bytes); };
  // A batch without normals gets zeros.
  const std::vector<glm::vec3> zeros(desc.normals.empty() ? desc.positions.size() : 0, glm::vec3(0.0F));
  std::array<std::span<const std::byte>, vertex_stream_count> streams;
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    const bool is_zero = VertexStream(i) == VertexStream::Normal && desc.normals.empty();
    streams[i] = is_zero ? std::as_bytes(std::span(zeros)) : desc.bytes(VertexStream(i));
    need(i, streams[i].empty() ? 0 : VkDeviceSize(vertex_capacity) * vertex_formats()[i].size_bytes);
  }
  need(index_pool, VkDeviceSize(index_capacity) * sizeof(std::uint32_t));
  if (sizes != before) {
    grow_pools(desc, sizes);
  }
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    write(pools_[i], VkDeviceSize(range.base_vertex) * vertex_formats()[i].size_bytes, streams[i]);
  }
  write(pools_[index_pool], VkDeviceSize(range.first_index) * sizeof(std::uint32_t), std::as_bytes(desc.indices));
  finish_large_uploads();
  check(fmt::format("batch '{}'", desc.name));
}

void VulkanDevice::batch_update(std::uint32_t first_vertex, const BatchDesc &values)
{
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    write(pools_[i], VkDeviceSize(first_vertex) * vertex_formats()[i].size_bytes, values.bytes(VertexStream(i)));
  }
  finish_large_uploads();
}

void VulkanDevice::host_batch_create(ResourceId id, const std::string &name, const HostBatch &batch)
{
  const std::string what = fmt::format("batch '{}'", name);
  check_host(what, "buffers");
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    const HostStream &stream = batch.stream(VertexStream(i));
    if (stream.buffer == 0) {
      continue;
    }
    const std::string_view stream_name = to_string(VertexStream(i));
    const std::uint32_t component_bytes = gpu::size_bytes(stream.type);
    if (stream.offset_bytes % component_bytes != 0 || stream.stride_bytes % component_bytes != 0) {
      throw Error("{}: the {} of the host begin at byte {} with a stride of {} bytes, no multiples of {}", what,
                  stream_name, stream.offset_bytes, stream.stride_bytes, component_bytes);
    }
    const std::uint32_t vertex_bytes = std::uint32_t(vertex_formats()[i].component_count) * component_bytes;
    if (std::uint32_t(stream.stride_bytes) < vertex_bytes) {
      throw Error("{}: the {} of the host have a stride of {} bytes, and each has {}", what, stream_name,
                  stream.stride_bytes, vertex_bytes);
    }
    const VkFormat format = vertex_format(vertex_formats()[i].component_count, stream.type);
    VkFormatProperties properties{};
    context_->instance.vkGetPhysicalDeviceFormatProperties(context_->physical_device, format, &properties);
    if ((properties.bufferFeatures & VK_FORMAT_FEATURE_VERTEX_BUFFER_BIT) == 0) {
      throw Error("{}: the device reads no {} of VkFormat {} from buffers", what, stream_name, int(format));
    }
  }
  host_batches_.insert(id, batch);
}

void VulkanDevice::shader_create(const Operation::CreateShader &create, std::vector<std::byte> &compiled)
{
  const std::string variant = fmt::format("{} {}", create.desc.name, fmt::join(create.desc.defines, " "));
  const trace::Span span(compiled.empty() ? "compile program" : "load program", variant);
  std::vector<SpirvStage> stages = unpacked(compiled);
  if (stages.empty()) {
    stages = compile_(create.desc.name, create.stages);
    compiled = packed(stages);
  }
  programs_.insert(create.id,
                   std::make_shared<VulkanProgram>(*context_, create.desc.name, variant, stages, create.constants));
  check_made(ResourceKind::Shader, create.id, fmt::format("shader '{}'", create.desc.name));
}

void VulkanDevice::timer_query_create(ResourceId id, const std::string &name)
{
  timers_.insert(id, Timer{name, {}, {}});
}

void VulkanDevice::resource_destroy(ResourceKind kind, ResourceId id)
{
  switch (kind) {
    case ResourceKind::Texture: {
      submissions_.retire([this, texture = textures_.at(id)] {
        if (texture.copy) {
          destroy_image(*context_, memory_, *texture.copy);
        }
        destroy_image(*context_, memory_, texture.image);
        context_->vk.vkDestroyBufferView(context_->device, texture.buffer_view, nullptr);
        memory_.destroy(texture.buffer);
      });
      textures_.erase(id);
      break;
    }
    case ResourceKind::Sampler:
      submissions_.retire(
          [this, sampler = samplers_.at(id)] { context_->vk.vkDestroySampler(context_->device, sampler, nullptr); });
      samplers_.erase(id);
      break;
    case ResourceKind::Framebuffer:
      submissions_.retire([this, framebuffer = framebuffers_.at(id)] { destroy_framebuffer(framebuffer); });
      framebuffers_.erase(id);
      break;
    case ResourceKind::Buffer:
      submissions_.retire([this, buffer = buffers_.at(id)] { memory_.destroy(buffer); });
      buffers_.erase(id);
      break;
    case ResourceKind::Shader:
      submissions_.retire([program = programs_.at(id)]() mutable { program.reset(); });
      programs_.erase(id);
      break;
    case ResourceKind::TimerQuery:
      submissions_.retire([this, timer = timers_.at(id)]() mutable {
        timer.unused.insert(timer.unused.end(), timer.pending.begin(), timer.pending.end());
        for (const TimeMarks &marks : timer.unused) {
          context_->vk.vkDestroyQueryPool(context_->device, marks.queries, nullptr);
        }
      });
      timers_.erase(id);
      break;
    case ResourceKind::Batch: host_batches_.erase(id); break;
  }
}

void VulkanDevice::write(const VulkanBuffer &buffer, VkDeviceSize offset_bytes, std::span<const std::byte> bytes)
{
  if (bytes.empty()) {
    return;
  }
  VkCommandBuffer commands = submissions_.commands();
  const VulkanStream::Place place = stream_.write(bytes, texel_alignment);
  barriers_.before_copy(VK_NULL_HANDLE, {buffer.handle, offset_bytes, bytes.size()});
  barriers_.record(commands);
  const VkBufferCopy region{place.offset_bytes, offset_bytes, bytes.size()};
  context_->vk.vkCmdCopyBuffer(commands, place.buffer, buffer.handle, 1, &region);
}

void VulkanDevice::finish_large_uploads()
{
  if (stream_.used_bytes() > stream_bytes_max) {
    submissions_.finish();
    stream_.collect();
  }
}

void VulkanDevice::buffer_update(ResourceId id, std::size_t offset_bytes, std::span<const std::byte> bytes)
{
  write(buffers_.at(id), offset_bytes, bytes);
  finish_large_uploads();
}

void VulkanDevice::texture_upload(ResourceId id, int layer, std::span<const std::byte> texels)
{
  VulkanTexture &texture = textures_.at(id);
  if (texture.desc.kind == TextureKind::Buffer) {
    write(texture.buffer, 0, texels);
  }
  else {
    VulkanImage &image = texture.image;
    VkCommandBuffer commands = submissions_.commands();
    barriers_.before_use(image, use::copied_to);
    barriers_.record(commands);
    for (std::uint32_t level = 0; !texels.empty(); level++) {
      VkBufferImageCopy region = region_of(image, 0, level, layer);
      const std::size_t size = std::size_t(region.imageExtent.width) * std::size_t(region.imageExtent.height) *
                               std::size_t(texel_size_bytes(texture.desc.format));
      const VulkanStream::Place place = stream_.write(texels.first(size), texel_alignment);
      region.bufferOffset = place.offset_bytes;
      context_->vk.vkCmdCopyBufferToImage(commands, place.buffer, image.handle, image.last_use.layout, 1, &region);
      texels = texels.subspan(size);
    }
  }
  finish_large_uploads();
  check(fmt::format("texture '{}'", texture.desc.name));
}

void VulkanDevice::mipmaps_generate(ResourceId id)
{
  VulkanTexture &texture = textures_.at(id);
  VulkanImage &image = texture.image;
  VkCommandBuffer commands = submissions_.commands();
  barriers_.before_use(image, use::copied_to);
  barriers_.record(commands);
  // The levels are read one after another, each after it was written: a barrier of one level each.
  VkImageMemoryBarrier2 barrier{};
  barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2;
  barrier.srcStageMask = use::copied_to.stages;
  barrier.srcAccessMask = use::copied_to.access;
  barrier.dstStageMask = use::copied_from.stages;
  barrier.dstAccessMask = use::copied_from.access;
  barrier.oldLayout = use::copied_to.layout;
  barrier.newLayout = use::copied_from.layout;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image.handle;
  VkDependencyInfo dependency{};
  dependency.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  dependency.imageMemoryBarrierCount = 1;
  dependency.pImageMemoryBarriers = &barrier;
  const auto end_of = [&](std::uint32_t level) {
    const VkExtent3D extent = extent_of(image, level);
    return VkOffset3D{std::int32_t(extent.width), std::int32_t(extent.height), 1};
  };
  for (std::uint32_t level = 0; level < image.levels; level++) {
    barrier.subresourceRange = {image.aspect, level, 1, 0, image.layers};
    context_->vk.vkCmdPipelineBarrier2(commands, &dependency);
    if (level + 1 < image.levels) {
      const VkImageBlit blit{{image.aspect, level, 0, image.layers},
                             {{0, 0, 0}, end_of(level)},
                             {image.aspect, level + 1, 0, image.layers},
                             {{0, 0, 0}, end_of(level + 1)}};
      context_->vk.vkCmdBlitImage(commands, image.handle, use::copied_from.layout, image.handle, use::copied_to.layout,
                                  1, &blit, VK_FILTER_LINEAR);
    }
  }
  image.last_use = use::copied_from;
  check(fmt::format("texture '{}'", texture.desc.name));
}

void VulkanDevice::layers_copy(ResourceId source, ResourceId target, glm::ivec2 size_px, int layers)
{
  VulkanTexture &from = textures_.at(source);
  VulkanTexture &to = textures_.at(target);
  VkCommandBuffer commands = submissions_.commands();
  barriers_.before_use(from.image, use::copied_from);
  barriers_.before_use(to.image, use::copied_to);
  barriers_.record(commands);
  const VkImageSubresourceLayers subresource{from.image.aspect, 0, 0, std::uint32_t(layers)};
  const VkImageCopy region{
      subresource, {0, 0, 0}, subresource, {0, 0, 0}, {std::uint32_t(size_px.x), std::uint32_t(size_px.y), 1}};
  context_->vk.vkCmdCopyImage(commands, from.image.handle, from.image.last_use.layout, to.image.handle,
                              to.image.last_use.layout, 1, &region);
  check(fmt::format("copy of texture '{}'", from.desc.name));
}

void VulkanDevice::texture_read(ResourceId id, int layer, std::span<std::byte> texels)
{
  VulkanTexture &texture = textures_.at(id);
  const std::string what = fmt::format("texture '{}'", texture.desc.name);
  // A pointer owns the buffer, because any of the calls may throw.
  const auto destroy = [this](const VulkanBuffer *buffer) {
    submissions_.retire([this, buffer] {
      memory_.destroy(*buffer);
      delete buffer;
    });
  };
  const std::unique_ptr<VulkanBuffer, decltype(destroy)> buffer(
      new VulkanBuffer(memory_.make_buffer(what, texels.size(), VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::Readback)),
      destroy);
  VkCommandBuffer commands = submissions_.commands();
  if (texture.desc.kind == TextureKind::Buffer) {
    barriers_.before_copy(texture.buffer.handle, {});
    barriers_.record(commands);
    const VkBufferCopy region{0, 0, texels.size()};
    context_->vk.vkCmdCopyBuffer(commands, texture.buffer.handle, buffer->handle, 1, &region);
  }
  else {
    barriers_.before_use(texture.image, use::copied_from);
    barriers_.record(commands);
    const VkBufferImageCopy region = region_of(texture.image, 0, 0, layer);
    context_->vk.vkCmdCopyImageToBuffer(commands, texture.image.handle, texture.image.last_use.layout, buffer->handle,
                                        1, &region);
  }
  // So that the CPU reads the values that the device has written.
  const VkMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,   nullptr,
                                 VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                                 VK_PIPELINE_STAGE_2_HOST_BIT,         VK_ACCESS_2_HOST_READ_BIT};
  VkDependencyInfo dependency{};
  dependency.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO;
  dependency.memoryBarrierCount = 1;
  dependency.pMemoryBarriers = &barrier;
  context_->vk.vkCmdPipelineBarrier2(commands, &dependency);
  submissions_.finish();
  memory_.invalidate(*buffer);
  std::memcpy(texels.data(), buffer->place.mapped(), texels.size());
  check(what);
}

}  // namespace gnomon::gpu
