// SPDX-License-Identifier: MIT
#include "vulkan_device.hh"

#include "trace.hh"

#include <algorithm>
#include <utility>

namespace gnomon::gpu {

namespace {

Limits limits_of(const VulkanContext &context)
{
  const VkPhysicalDeviceLimits &of = context.limits;
  Limits limits;
  // A texture of any size can be attached to a framebuffer.
  limits.texture_size_max = int(std::min({of.maxImageDimension2D, of.maxFramebufferWidth, of.maxFramebufferHeight}));
  limits.array_layers_max = int(of.maxImageArrayLayers);
  limits.buffer_texels_max = int(std::min(of.maxTexelBufferElements, std::uint32_t(1) << 30U));
  limits.uniform_block_bytes_max = of.maxUniformBufferRange;
  limits.storage_block_bytes_max = of.maxStorageBufferRange;
  limits.push_constant_bytes_max = push_constant_bytes;
  limits.color_attachment_max = int(std::min(of.maxColorAttachments, std::uint32_t(PipelineKey::color_count_max)));
  limits.anisotropy_max = context.has_anisotropy ? int(of.maxSamplerAnisotropy) : 1;
  limits.is_software = context.is_software;
  limits.subpixel_bits = int(of.subPixelPrecisionBits);
  limits.uniform_offset_alignment =
      std::uint32_t(std::max(of.minUniformBufferOffsetAlignment, of.minStorageBufferOffsetAlignment));
  for (Limits::Stage &stage : limits.stages) {
    stage = {int(of.maxPerStageDescriptorStorageBuffers), int(of.maxPerStageDescriptorUniformBuffers),
             int(std::min(of.maxPerStageDescriptorSamplers, of.maxPerStageDescriptorSampledImages))};
  }
  constexpr std::uint32_t components_of_location = 4;
  limits.varying_location_max =
      int(std::min(of.maxVertexOutputComponents, of.maxFragmentInputComponents) / components_of_location);
  limits.has_vertex_layer = context.has_vertex_layer;
  limits.has_geometry_shader = context.has_geometry_shader;
  limits.has_wireframe = context.has_wireframe;
  limits.has_specialization = true;
  return limits;
}

}  // namespace

VulkanDevice::VulkanDevice(std::unique_ptr<VulkanContext> context, const VulkanDeviceDesc &desc)
    : Device(limits_of(*context), desc.sink, desc.shader_cache_folder),
      context_(std::move(context)),
      compile_(desc.compile_spirv),
      memory_(*context_),
      submissions_(*context_),
      stream_(*context_, memory_, submissions_),
      descriptors_(*context_, submissions_),
      barriers_(*context_)
{
  try {
    create_dummies();
    check("Vulkan");
  }
  catch (...) {
    destroy_dummies();
    throw;
  }
}

VulkanDevice::~VulkanDevice()
{
  free_live_resources();
  try {
    submissions_.flush();
  }
  catch (const Error &error) {
    message(error.what());
  }
  submissions_.end();
  destroy_dummies();
  for (const VulkanBuffer &pool : pools_) {
    memory_.destroy(pool);
  }
}

void VulkanDevice::check_made(ResourceKind kind, ResourceId id, std::string_view what)
{
  try {
    check(what);
  }
  catch (...) {
    resource_destroy(kind, id);
    throw;
  }
}

void VulkanDevice::create_dummies()
{
  const std::string what = "black textures";
  for (const bool is_depth : {false, true}) {
    const TextureDesc desc{
        .name = "unbound", .kind = TextureKind::Array, .format = is_depth ? Format::Depth32F : Format::RGBA8};
    VulkanImage &image = dummies_.images[is_depth];
    image = make_image(*context_, memory_, what, desc, vulkan_format(desc.format));
    dummies_.flat_views[is_depth] =
        make_view(*context_, what, image, image.format, VK_IMAGE_VIEW_TYPE_2D, {image.aspect, 0, 1, 0, 1});
    VkSamplerCreateInfo sampler{};
    sampler.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO;
    sampler.compareEnable = is_depth ? VK_TRUE : VK_FALSE;
    sampler.compareOp = VK_COMPARE_OP_GREATER_OR_EQUAL;
    dummies_.samplers[is_depth] = make_sampler(what, sampler);
    barriers_.before_use(image, use::copied_to);
  }
  constexpr VkDeviceSize block_bytes = 65536;
  dummies_.buffer = memory_.make_buffer(what, block_bytes,
                                        VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT |
                                            VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                                            VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                        MemoryUse::Device);
  constexpr VkDeviceSize white_bytes = 16;
  dummies_.white = memory_.make_buffer(
      what, white_bytes, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::Device);
  VkBufferViewCreateInfo view{};
  view.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO;
  view.buffer = dummies_.buffer.handle;
  view.format = VK_FORMAT_R8G8B8A8_UNORM;
  view.range = block_bytes;
  context_->check(context_->vk.vkCreateBufferView(context_->device, &view, nullptr, &dummies_.buffer_view), what);
  barriers_.before_copy(VK_NULL_HANDLE, {dummies_.buffer.handle, 0, dummies_.buffer.size_bytes});
  barriers_.before_copy(VK_NULL_HANDLE, {dummies_.white.handle, 0, dummies_.white.size_bytes});
  VkCommandBuffer commands = submissions_.commands();
  barriers_.record(commands);
  context_->vk.vkCmdFillBuffer(commands, dummies_.buffer.handle, 0, VK_WHOLE_SIZE, 0);
  context_->vk.vkCmdFillBuffer(commands, dummies_.white.handle, 0, VK_WHOLE_SIZE, ~std::uint32_t(0));
  const VkImageSubresourceRange color{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  const VkImageSubresourceRange depth{VK_IMAGE_ASPECT_DEPTH_BIT, 0, 1, 0, 1};
  constexpr VkClearColorValue black{};
  constexpr VkClearDepthStencilValue far{};
  context_->vk.vkCmdClearColorImage(commands, dummies_.images[0].handle, dummies_.images[0].last_use.layout, &black, 1,
                                    &color);
  context_->vk.vkCmdClearDepthStencilImage(commands, dummies_.images[1].handle, dummies_.images[1].last_use.layout,
                                           &far, 1, &depth);
  for (VulkanImage &image : dummies_.images) {
    barriers_.before_use(image, use::sampled);
  }
  barriers_.record(commands);
}

void VulkanDevice::destroy_dummies()
{
  context_->vk.vkDestroyBufferView(context_->device, dummies_.buffer_view, nullptr);
  memory_.destroy(dummies_.buffer);
  memory_.destroy(dummies_.white);
  for (const bool is_depth : {false, true}) {
    context_->vk.vkDestroySampler(context_->device, dummies_.samplers[is_depth], nullptr);
    context_->vk.vkDestroyImageView(context_->device, dummies_.flat_views[is_depth], nullptr);
    destroy_image(*context_, memory_, dummies_.images[is_depth]);
  }
}

void VulkanDevice::finish()
{
  const trace::Span span("wait for the device");
  submissions_.finish();
  check("finish");
}

bool VulkanDevice::driver_trim()
{
  submissions_.finish();
  // SwiftShader takes 10.5 MiB for a pool.
  const bool has_pools = descriptors_.trim();
  return memory_.trim() || has_pools;
}

void VulkanDevice::time_mark(ResourceId query, bool is_end)
{
  if (context_->timestamp_bits == 0) {
    return;
  }
  Timer &timer = timers_.at(query);
  // A begin whose end was not executed, because a packet failed between them, is marked again.
  if (!is_end && !std::exchange(timer.has_begun, true)) {
    // So that they do not grow in number if nobody takes the times.
    read_times(timer, false);
    if (timer.unused.empty()) {
      VkQueryPoolCreateInfo info{};
      info.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO;
      info.queryType = VK_QUERY_TYPE_TIMESTAMP;
      info.queryCount = 2;
      TimeMarks marks;
      context_->check(context_->vk.vkCreateQueryPool(context_->device, &info, nullptr, &marks.queries), "timer");
      context_->label(VK_OBJECT_TYPE_QUERY_POOL, marks.queries, timer.name);
      timer.unused.push_back(marks);
    }
    timer.pending.push_back(timer.unused.back());
    timer.unused.pop_back();
    context_->vk.vkResetQueryPool(context_->device, timer.pending.back().queries, 0, 2);
  }
  else if (!is_end) {
    // The first mark may have been submitted.
    submissions_.finish();
    context_->vk.vkResetQueryPool(context_->device, timer.pending.back().queries, 0, 2);
  }
  if (timer.has_begun) {
    TimeMarks &marks = timer.pending.back();
    context_->vk.vkCmdWriteTimestamp2(submissions_.commands(), VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, marks.queries,
                                      is_end ? 1 : 0);
    marks.number = submissions_.number();
    timer.has_begun = !is_end;
  }
}

void VulkanDevice::read_times(Timer &timer, bool waits)
{
  if (waits) {
    submissions_.finish();
  }
  const std::uint64_t done = submissions_.done();
  while (timer.pending.size() > (timer.has_begun ? 1 : 0) && timer.pending.front().number <= done) {
    const TimeMarks marks = timer.pending.front();
    std::array<std::uint64_t, 2> ticks{};
    context_->check(context_->vk.vkGetQueryPoolResults(context_->device, marks.queries, 0, 2, sizeof(ticks),
                                                       ticks.data(), sizeof(ticks[0]), VK_QUERY_RESULT_64_BIT),
                    "timer");
    timer.seconds += double(elapsed_ticks(ticks[0], ticks[1], context_->timestamp_bits)) *
                     double(context_->limits.timestampPeriod) * 1e-9;
    timer.pending.erase(timer.pending.begin());
    timer.unused.push_back(marks);
  }
}

std::optional<double> VulkanDevice::seconds_take(ResourceId query)
{
  if (context_->timestamp_bits == 0) {
    return std::nullopt;
  }
  Timer &timer = timers_.at(query);
  read_times(timer, true);
  check("timer");
  return std::exchange(timer.seconds, 0.0);
}

std::unique_ptr<Device> VulkanDevice::create(const VulkanDeviceDesc &desc, GLFWwindow *window)
{
  if (!desc.compile_spirv) {
    throw Error("Vulkan: the program has no compiler of shaders for it");
  }
  if (desc.host) {
    return std::make_unique<VulkanDevice>(std::make_unique<VulkanContext>(*desc.host), desc);
  }
  return std::make_unique<VulkanDevice>(
      std::make_unique<VulkanContext>(desc.is_debug, window,
                                      [sink = desc.sink](std::string_view text) { send_message(sink, text); }),
      desc);
}

std::unique_ptr<Device> create_vulkan_device(const VulkanDeviceDesc &desc)
{
  return VulkanDevice::create(desc, nullptr);
}

}  // namespace gnomon::gpu
