// SPDX-License-Identifier: MIT
#include "vulkan_device.hh"

#include "draw_object_shared.h"
#include "slots_shared.h"
#include "trace.hh"

#include <algorithm>
#include <utility>

namespace gnomon::gpu {

namespace {

/** The entry of \a slot, which is made if there is none. */
template <typename T>
T &entry(std::vector<T> &entries, std::uint32_t slot)
{
  if (slot >= entries.size()) {
    entries.resize(std::size_t(slot) + 1);
  }
  return entries[slot];
}

VkRect2D vulkan_rectangle(const Rectangle &rectangle, glm::ivec2 size_px)
{
  const Rectangle of = rectangle.is_whole() ? Rectangle{{0, 0}, size_px} : rectangle;
  return {{of.origin_px.x, of.origin_px.y}, {std::uint32_t(of.size_px.x), std::uint32_t(of.size_px.y)}};
}

VkAttachmentLoadOp vulkan_load(LoadAction action)
{
  switch (action) {
    case LoadAction::Load: return VK_ATTACHMENT_LOAD_OP_LOAD;
    case LoadAction::Clear: return VK_ATTACHMENT_LOAD_OP_CLEAR;
    case LoadAction::DontCare: return VK_ATTACHMENT_LOAD_OP_DONT_CARE;
  }
  return VK_ATTACHMENT_LOAD_OP_LOAD;
}

VkAttachmentStoreOp vulkan_store(StoreAction action)
{
  return action == StoreAction::Store ? VK_ATTACHMENT_STORE_OP_STORE : VK_ATTACHMENT_STORE_OP_DONT_CARE;
}

VkCompareOp vulkan_compare(State state)
{
  return has(state, State::DepthEqual)         ? VK_COMPARE_OP_EQUAL
         : has(state, State::DepthNearerEqual) ? VK_COMPARE_OP_GREATER_OR_EQUAL
         : has(state, State::DepthLessEqual)   ? VK_COMPARE_OP_LESS_OR_EQUAL
         : has(state, State::DepthFurther)     ? VK_COMPARE_OP_LESS
                                               : VK_COMPARE_OP_ALWAYS;
}

}  // namespace

void VulkanDevice::list_submit(const CommandList &list)
{
  const trace::Span span("submit", list.passes().empty() ? std::string_view() : list.name_of(list.passes().front()));
  try {
    execute(list);
  }
  catch (...) {
    if (list_.pass) {
      end_pass();
    }
    // The images have the layouts after these barriers.
    barriers_.record(submissions_.commands());
    // They are about this list, and the next call must not report them as its own.
    static_cast<void>(context_->take_messages());
    throw;
  }
  submissions_.flush();
  check("submit");
}

void VulkanDevice::bind_texture(const Command &command, std::vector<BoundTexture> &textures)
{
  if (command.id != 0) {
    static_cast<void>(textures_.at(command.id));
    static_cast<void>(samplers_.at(command.first));
  }
  entry(textures, command.slot) = {command.id, command.first};
}

std::vector<VulkanDevice::PassTextures> VulkanDevice::textures_of_passes(const CommandList &list)
{
  std::vector<PassTextures> passes;
  std::vector<BoundTexture> bound;
  const VulkanProgram *program = nullptr;
  bool is_changed = true;
  for (const Command &command : list.commands()) {
    switch (command.kind) {
      case CommandKind::BeginPass:
        passes.emplace_back();
        is_changed = true;
        break;
      case CommandKind::SetShader:
        program = programs_.at(command.id).get();
        is_changed = true;
        break;
      case CommandKind::BindTexture:
        bind_texture(command, bound);
        is_changed = true;
        break;
      case CommandKind::Draw:
      case CommandKind::DrawProcedural:
        if (program && std::exchange(is_changed, false)) {
          for (const VulkanBinding &binding : program->interface().bindings) {
            if (binding.type == VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER && binding.slot < bound.size() &&
                bound[binding.slot].texture != 0) {
              passes.back().push_back(bound[binding.slot].texture);
            }
          }
        }
        break;
      default: break;
    }
  }
  for (PassTextures &textures : passes) {
    std::ranges::sort(textures);
    textures.erase(std::unique(textures.begin(), textures.end()), textures.end());
  }
  return passes;
}

void VulkanDevice::execute(const CommandList &list)
{
  const std::vector<PassTextures> used = textures_of_passes(list);
  std::size_t pass_count = 0;
  list_ = {};
  VkCommandBuffer commands = submissions_.commands();
  constexpr VkDeviceSize alignment = 16;
  list_.instances = stream_.write(std::as_bytes(std::span(list.instances)), alignment);
  list_.draws = stream_.write(std::as_bytes(std::span(list.draws)), alignment);
  const auto bytes_of = [&](const Command &command) {
    return std::span(list.bytes()).subspan(command.first, command.count);
  };
  const auto buffer_info = [&](const Command &command, VkDeviceSize size_max) {
    const VulkanBuffer &buffer = buffers_.at(command.id);
    const VkDeviceSize size = command.count > 0 ? command.count : buffer.size_bytes - command.first;
    return VkDescriptorBufferInfo{buffer.handle, command.first, std::min(size, size_max)};
  };
  for (const Command &command : list.commands()) {
    switch (command.kind) {
      case CommandKind::BeginPass: {
        const CommandList::PassInfo &pass = list.passes()[command.first];
        begin_pass(list.name_of(pass), pass, used[pass_count++]);
        break;
      }
      case CommandKind::EndPass: end_pass(); break;
      case CommandKind::SetShader:
        list_.program = programs_.at(command.id).get();
        list_.has_new_bindings = true;
        list_.has_new_vertices = true;
        break;
      case CommandKind::SetState: set_state(State(command.first)); break;
      case CommandKind::BindUniform:
        entry(list_.uniforms, command.slot) = buffer_info(command, limits().uniform_block_bytes_max);
        list_.has_new_bindings = true;
        break;
      case CommandKind::BindStorage:
        entry(list_.storages, command.slot) = buffer_info(command, limits().storage_block_bytes_max);
        list_.has_new_bindings = true;
        break;
      case CommandKind::BindTexture:
        bind_texture(command, list_.textures);
        list_.has_new_bindings = true;
        break;
      case CommandKind::BindInstances:
        list_.objects = command.id;
        list_.has_new_vertices = true;
        break;
      case CommandKind::BindHostBatch:
        list_.host_batch = command.id == 0 ? nullptr : &host_batches_.at(command.id);
        list_.has_new_vertices = true;
        break;
      case CommandKind::PushConstants:
        list_.push_constants = bytes_of(command);
        list_.has_new_push_constants = true;
        break;
      case CommandKind::Draw:
        if (prepare_draw(false)) {
          const std::uint32_t most = context_->limits.maxDrawIndirectCount;
          for (std::uint32_t i = 0; i < command.count; i += most) {
            context_->vk.vkCmdDrawIndexedIndirect(
                commands, list_.draws.buffer,
                list_.draws.offset_bytes + VkDeviceSize(command.first + i) * sizeof(DrawIndirect),
                std::min(command.count - i, most), sizeof(DrawIndirect));
          }
        }
        break;
      case CommandKind::DrawProcedural:
        if (prepare_draw(true)) {
          context_->vk.vkCmdDraw(commands, command.first, command.count, 0, 0);
        }
        break;
      case CommandKind::Update: write(buffers_.at(command.id), command.slot, bytes_of(command)); break;
    }
  }
}

void VulkanDevice::check_host_image(std::string_view pass_name, const VulkanFramebuffer &framebuffer,
                                    const PassActions &actions)
{
  const auto refuse = [&](std::string_view why) {
    throw Error("pass '{}': framebuffer '{}' of the host's image {}", pass_name, framebuffer.name, why);
  };
  if (!framebuffer.host->is_taken) {
    refuse("is drawn into outside of begin_image and end_image");
  }
  const bool is_srgb = unencoded(framebuffer.host->image.format) != framebuffer.host->image.format;
  if (actions.is_srgb_encoded && !is_srgb) {
    refuse("has no sRGB format, which would encode the colours");
  }
  if (!actions.is_srgb_encoded && is_srgb && !framebuffer.host->turned) {
    refuse("has an sRGB format, which encodes the colours");
  }
}

void VulkanDevice::prepare_lookups(const VulkanFramebuffer &framebuffer, const PassActions &actions,
                                   const PassTextures &used)
{
  // Textures that are looked up while they are drawn into are copied first.
  list_.copied.clear();
  for (const VulkanAttachment &color : framebuffer.colors) {
    if (actions.reads_attachments && std::ranges::binary_search(used, color.texture)) {
      copy_attachment(color.texture);
      list_.copied.push_back(color.texture);
    }
  }
  for (const ResourceId id : used) {
    // The host's have the layout that it says.
    if (textures_.at(id).desc.format != Format::Host && std::ranges::find(list_.copied, id) == list_.copied.end()) {
      barriers_.before_use(textures_.at(id).image, use::sampled);
    }
  }
}

void VulkanDevice::begin_pass(std::string_view name, const CommandList::PassInfo &pass, const PassTextures &used)
{
  if (pass.host_framebuffer) {
    throw Error("pass '{}': a device of Vulkan has no framebuffers of the host", name);
  }
  const VulkanFramebuffer &framebuffer = framebuffers_.at(pass.framebuffer);
  if (framebuffer.host) {
    check_host_image(name, framebuffer, pass.actions);
  }
  const PassActions &actions = pass.actions;
  VkCommandBuffer commands = submissions_.commands();
  prepare_lookups(framebuffer, actions, used);
  const bool is_encoded = actions.is_srgb_encoded;
  std::vector<VkRenderingAttachmentInfo> colors;
  list_.pipeline.colors = {};
  list_.pipeline.samples = framebuffer.host ? framebuffer.host->samples : VK_SAMPLE_COUNT_1_BIT;
  for (const VulkanAttachment &color : framebuffer.colors) {
    VulkanImage &image = framebuffer.host ? framebuffer.host->drawn() : textures_.at(color.texture).image;
    barriers_.before_use(image, use::color);
    list_.pipeline.colors[colors.size()] = color.formats[is_encoded];
    VkRenderingAttachmentInfo &info = colors.emplace_back();
    info.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
    info.imageView = color.views[is_encoded];
    info.imageLayout = image.last_use.layout;
    info.loadOp = vulkan_load(actions.color_load);
    info.storeOp = vulkan_store(actions.color_store);
    std::copy_n(&actions.clear_color[0], 4, info.clearValue.color.float32);
  }
  VkRenderingAttachmentInfo depth{};
  depth.sType = VK_STRUCTURE_TYPE_RENDERING_ATTACHMENT_INFO;
  list_.pipeline.depth = VK_FORMAT_UNDEFINED;
  if (framebuffer.depth) {
    VulkanImage &image = textures_.at(framebuffer.depth->texture).image;
    barriers_.before_use(image, use::depth);
    list_.pipeline.depth = image.format;
    depth.imageView = framebuffer.depth->views[0];
    depth.imageLayout = image.last_use.layout;
    depth.loadOp = vulkan_load(actions.depth_load);
    depth.storeOp = vulkan_store(actions.depth_store);
    depth.clearValue.depthStencil.depth = actions.clear_depth;
  }
  barriers_.before_draws();
  barriers_.record(commands);
  // Clears respect the scissor.
  const VkRect2D scissor = vulkan_rectangle(actions.scissor, framebuffer.size_px);
  VkRenderingInfo info{};
  info.sType = VK_STRUCTURE_TYPE_RENDERING_INFO;
  info.renderArea = scissor;
  info.layerCount = framebuffer.layer_count;
  info.colorAttachmentCount = std::uint32_t(colors.size());
  info.pColorAttachments = colors.data();
  info.pDepthAttachment = framebuffer.depth ? &depth : nullptr;
  // list_submit() closes the label only if list_.pass is set, so nothing in between may throw.
  context_->begin_label(commands, name);
  context_->vk.vkCmdBeginRendering(commands, &info);
  list_.pass = &pass;
  const VkRect2D area = vulkan_rectangle(actions.viewport, framebuffer.size_px);
  const VkViewport viewport{
      float(area.offset.x), float(area.offset.y), float(area.extent.width), float(area.extent.height), 0.0F, 1.0F};
  context_->vk.vkCmdSetViewport(commands, 0, 1, &viewport);
  context_->vk.vkCmdSetScissor(commands, 0, 1, &scissor);
  const DepthBias &bias = actions.depth_bias;
  context_->vk.vkCmdSetDepthBiasEnable(commands, bias != DepthBias() ? VK_TRUE : VK_FALSE);
  context_->vk.vkCmdSetDepthBias(commands, bias.constant, 0.0F, bias.slope);
  list_.has_new_bindings = true;
}

void VulkanDevice::copy_attachment(ResourceId id)
{
  VulkanTexture &texture = textures_.at(id);
  if (!texture.copy) {
    texture.copy = make_image(*context_, memory_, fmt::format("copy of texture '{}'", texture.desc.name), texture.desc,
                              vulkan_format(texture.desc.format));
  }
  VulkanImage &image = texture.image;
  VkCommandBuffer commands = submissions_.commands();
  barriers_.before_use(image, use::copied_from);
  barriers_.before_use(*texture.copy, use::copied_to);
  barriers_.record(commands);
  std::vector<VkImageCopy> regions;
  for (std::uint32_t level = 0; level < image.levels; level++) {
    const VkImageSubresourceLayers layers{image.aspect, level, 0, image.layers};
    regions.push_back({layers, {0, 0, 0}, layers, {0, 0, 0}, extent_of(image, level)});
  }
  context_->vk.vkCmdCopyImage(commands, image.handle, image.last_use.layout, texture.copy->handle,
                              texture.copy->last_use.layout, std::uint32_t(regions.size()), regions.data());
  barriers_.before_use(*texture.copy, use::sampled);
}

void VulkanDevice::end_pass()
{
  context_->vk.vkCmdEndRendering(submissions_.commands());
  context_->end_label(submissions_.commands());
  list_.pass = nullptr;
}

void VulkanDevice::set_state(State state)
{
  VkCommandBuffer commands = submissions_.commands();
  list_.pipeline.state = pipeline_state(state);
  const VkCompareOp compare = vulkan_compare(state);
  const bool is_written = has(state, State::WriteDepth);
  if (list_.pass && (is_written || compare != VK_COMPARE_OP_ALWAYS)) {
    const VulkanFramebuffer &framebuffer = framebuffers_.at(list_.pass->framebuffer);
    if (framebuffer.host) {
      throw Error("framebuffer '{}' of the host's image has no depth, which draws test or write", framebuffer.name);
    }
  }
  // Depth is written only if it is tested, as in OpenGL.
  context_->vk.vkCmdSetDepthTestEnable(commands, compare != VK_COMPARE_OP_ALWAYS || is_written ? VK_TRUE : VK_FALSE);
  context_->vk.vkCmdSetDepthWriteEnable(commands, is_written ? VK_TRUE : VK_FALSE);
  context_->vk.vkCmdSetDepthCompareOp(commands, compare);
  context_->vk.vkCmdSetCullMode(commands, has(state, State::CullFront)  ? VK_CULL_MODE_FRONT_BIT
                                          : has(state, State::CullBack) ? VK_CULL_MODE_BACK_BIT
                                                                        : VK_CULL_MODE_NONE);
  // The first row of a framebuffer is its top in Vulkan and its bottom here, so that windings swap.
  context_->vk.vkCmdSetFrontFace(
      commands, has(state, State::FrontClockwise) ? VK_FRONT_FACE_COUNTER_CLOCKWISE : VK_FRONT_FACE_CLOCKWISE);
}

bool VulkanDevice::prepare_draw(bool is_procedural)
{
  if (!list_.program || (!is_procedural && !list_.host_batch && pools_[index_pool].handle == VK_NULL_HANDLE)) {
    return false;
  }
  VkCommandBuffer commands = submissions_.commands();
  list_.pipeline.is_procedural = is_procedural;
  list_.pipeline.has_objects = !is_procedural && list_.objects != 0;
  list_.pipeline.vertex_types = vertex_types(is_procedural ? nullptr : list_.host_batch);
  const auto [pipeline, is_new] = list_.program->pipeline(list_.pipeline);
  if (is_new) {
    count_pipeline();
  }
  if (std::exchange(list_.bound_pipeline, pipeline) != pipeline) {
    context_->vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
  }
  if (std::exchange(list_.has_new_push_constants, false)) {
    context_->vk.vkCmdPushConstants(commands, list_.program->layout(), VK_SHADER_STAGE_ALL_GRAPHICS, 0,
                                    std::uint32_t(list_.push_constants.size()), list_.push_constants.data());
  }
  if (std::exchange(list_.has_new_bindings, false)) {
    bind_descriptors();
  }
  if (!is_procedural && std::exchange(list_.has_new_vertices, false)) {
    bind_vertices();
  }
  return true;
}

VkDescriptorImageInfo VulkanDevice::image_info(const VulkanBinding &binding)
{
  constexpr VkImageLayout layout = use::sampled.layout;
  const BoundTexture bound = binding.slot < list_.textures.size() ? list_.textures[binding.slot] : BoundTexture();
  if (bound.texture == 0) {
    return {dummies_.samplers[binding.is_comparison],
            binding.is_array ? dummies_.images[binding.is_comparison].view : dummies_.flat_views[binding.is_comparison],
            layout};
  }
  const VulkanTexture &texture = textures_.at(bound.texture);
  const bool is_copied = std::ranges::find(list_.copied, bound.texture) != list_.copied.end();
  return {samplers_.at(bound.sampler), is_copied ? texture.copy->view : texture.image.view,
          texture.desc.format == Format::Host ? VkImageLayout(texture.desc.host.layout) : layout};
}

void VulkanDevice::bind_descriptors()
{
  const std::vector<VulkanBinding> &bindings = list_.program->interface().bindings;
  if (bindings.empty()) {
    return;
  }
  const VkDescriptorSet set = descriptors_.allocate(list_.program->set_layout());
  // Sized for all bindings, so that pointers to the elements stay valid.
  std::vector<VkDescriptorImageInfo> images(bindings.size());
  std::vector<VkDescriptorBufferInfo> buffers(bindings.size());
  std::vector<VkWriteDescriptorSet> writes(bindings.size());
  for (std::size_t i = 0; i < bindings.size(); i++) {
    const VulkanBinding &binding = bindings[i];
    VkWriteDescriptorSet &write = writes[i];
    write.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
    write.dstSet = set;
    write.dstBinding = binding.slot;
    write.descriptorCount = 1;
    write.descriptorType = binding.type;
    switch (binding.type) {
      case VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER:
        images[i] = image_info(binding);
        write.pImageInfo = &images[i];
        break;
      case VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER: {
        const bool is_bound = binding.slot < list_.textures.size() && list_.textures[binding.slot].texture != 0;
        write.pTexelBufferView =
            is_bound ? &textures_.at(list_.textures[binding.slot].texture).buffer_view : &dummies_.buffer_view;
        break;
      }
      default: {
        const auto &bound = binding.type == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER ? list_.uniforms : list_.storages;
        const bool is_bound = binding.slot < bound.size() && bound[binding.slot].buffer != VK_NULL_HANDLE;
        buffers[i] = is_bound ? bound[binding.slot]
                              : VkDescriptorBufferInfo{dummies_.buffer.handle, 0,
                                                       std::min<VkDeviceSize>(dummies_.buffer.size_bytes,
                                                                              limits().uniform_block_bytes_max)};
        write.pBufferInfo = &buffers[i];
        break;
      }
    }
  }
  context_->vk.vkUpdateDescriptorSets(context_->device, std::uint32_t(writes.size()), writes.data(), 0, nullptr);
  context_->vk.vkCmdBindDescriptorSets(submissions_.commands(), VK_PIPELINE_BIND_POINT_GRAPHICS,
                                       list_.program->layout(), 0, 1, &set, 0, nullptr);
}

void VulkanDevice::bind_vertices()
{
  VkCommandBuffer commands = submissions_.commands();
  const auto bind = [&](std::uint32_t binding, VkBuffer buffer, VkDeviceSize offset, VkDeviceSize stride) {
    context_->vk.vkCmdBindVertexBuffers2(commands, binding, 1, &buffer, &offset, nullptr, &stride);
  };
  const std::uint32_t inputs = list_.program->interface().vertex_inputs;
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    const VertexFormat &format = vertex_formats()[i];
    if ((inputs >> format.attribute & 1U) == 0) {
      continue;
    }
    if (!list_.host_batch) {
      // No batch has a stream that has no pool: the vertices read zeros.
      const bool is_absent = pools_[i].handle == VK_NULL_HANDLE;
      bind(format.attribute, is_absent ? dummies_.buffer.handle : pools_[i].handle, 0,
           is_absent ? 0 : format.size_bytes);
    }
    else if (const HostStream &stream = list_.host_batch->stream(VertexStream(i)); stream.buffer != 0) {
      bind(format.attribute, VkBuffer(std::uintptr_t(stream.buffer)), stream.offset_bytes, stream.stride_bytes);
    }
    else {
      const bool is_white = VertexStream(i) == VertexStream::Color;
      bind(format.attribute, is_white ? dummies_.white.handle : dummies_.buffer.handle, 0, 0);
    }
  }
  const VkBuffer objects = list_.objects == 0 ? dummies_.buffer.handle : buffers_.at(list_.objects).handle;
  const bool is_list = list_.objects == 0;
  bind(ATTRIBUTE_DRAW_INSTANCE, is_list ? list_.instances.buffer : objects, is_list ? list_.instances.offset_bytes : 0,
       is_list ? sizeof(DrawInstance) : sizeof(shared::ObjectData));
  bind(ATTRIBUTE_WORLD_FROM_OBJECT, objects, 0, is_list ? 0 : sizeof(shared::ObjectData));
  if (list_.host_batch) {
    const bool is_short = list_.host_batch->index_type == HostBatch::IndexType::Uint16;
    context_->vk.vkCmdBindIndexBuffer(commands, VkBuffer(std::uintptr_t(list_.host_batch->index_buffer)), 0,
                                      is_short ? VK_INDEX_TYPE_UINT16 : VK_INDEX_TYPE_UINT32);
  }
  else {
    context_->vk.vkCmdBindIndexBuffer(commands, pools_[index_pool].handle, 0, VK_INDEX_TYPE_UINT32);
  }
}

}  // namespace gnomon::gpu
