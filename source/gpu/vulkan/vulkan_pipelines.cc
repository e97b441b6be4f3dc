// SPDX-License-Identifier: MIT
#include "vulkan_pipelines.hh"

#include "draw_object_shared.h"
#include "gpu_command_list.hh"
#include "gpu_error.hh"
#include "slots_shared.h"
#include "trace.hh"

#include <algorithm>
#include <cstddef>

namespace gnomon::gpu {

namespace {

/** The vertex inputs of a program: as many bindings as are used. Their strides are dynamic. */
struct VertexInputs {
  std::vector<VkVertexInputAttributeDescription> attributes;
  std::vector<VkVertexInputBindingDescription> bindings;
};

VertexInputs vertex_inputs(std::uint32_t locations, bool has_objects, const VertexTypes &types)
{
  VertexInputs inputs;
  const auto add = [&](std::uint32_t location, std::uint32_t binding, VkFormat format, std::size_t offset_bytes,
                       VkVertexInputRate rate) {
    if ((locations >> location & 1U) == 0) {
      return;
    }
    inputs.attributes.push_back({location, binding, format, std::uint32_t(offset_bytes)});
    if (std::ranges::find(inputs.bindings, binding, &VkVertexInputBindingDescription::binding) ==
        inputs.bindings.end()) {
      inputs.bindings.push_back({binding, 0, rate});
    }
  };
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    const VertexFormat &format = vertex_formats()[i];
    add(format.attribute, format.attribute, vertex_format(format.component_count, types[i]), 0,
        VK_VERTEX_INPUT_RATE_VERTEX);
  }
  // The value of an instance is 0 in calls: the default of a component that is not in the buffer.
  add(ATTRIBUTE_DRAW_INSTANCE, ATTRIBUTE_DRAW_INSTANCE, has_objects ? VK_FORMAT_R32_UINT : VK_FORMAT_R32G32_UINT,
      has_objects ? offsetof(shared::ObjectData, index) : 0, VK_VERTEX_INPUT_RATE_INSTANCE);
  const auto of_object = [&](std::uint32_t location, VkFormat format, std::size_t offset_bytes) {
    add(location, ATTRIBUTE_WORLD_FROM_OBJECT, format, offset_bytes, VK_VERTEX_INPUT_RATE_INSTANCE);
  };
  for (std::uint32_t column = 0; column < 4; column++) {
    of_object(ATTRIBUTE_WORLD_FROM_OBJECT + column, VK_FORMAT_R32G32B32A32_SFLOAT,
              offsetof(shared::ObjectData, world_from_object) + column * sizeof(glm::vec4));
  }
  of_object(ATTRIBUTE_OBJECT_NORMAL_X, VK_FORMAT_R32G32B32_SFLOAT, offsetof(shared::ObjectData, normal_x));
  of_object(ATTRIBUTE_OBJECT_NORMAL_Y, VK_FORMAT_R32G32B32_SFLOAT, offsetof(shared::ObjectData, normal_y));
  of_object(ATTRIBUTE_OBJECT_NORMAL_Z, VK_FORMAT_R32G32B32_SFLOAT, offsetof(shared::ObjectData, normal_z));
  of_object(ATTRIBUTE_OBJECT_VALUE, VK_FORMAT_R32_UINT, offsetof(shared::ObjectData, value));
  return inputs;
}

VkPipelineColorBlendAttachmentState blending(State state)
{
  VkPipelineColorBlendAttachmentState blend{};
  if (has(state, State::WriteColor)) {
    blend.colorWriteMask =
        VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
  }
  blend.blendEnable = has(state, State::BlendAdd | State::BlendMultiply | State::BlendOver) ? VK_TRUE : VK_FALSE;
  const bool is_multiplied = has(state, State::BlendMultiply);
  blend.srcColorBlendFactor = is_multiplied ? VK_BLEND_FACTOR_DST_COLOR : VK_BLEND_FACTOR_ONE;
  blend.dstColorBlendFactor = is_multiplied                  ? VK_BLEND_FACTOR_ZERO
                              : has(state, State::BlendOver) ? VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA
                                                             : VK_BLEND_FACTOR_ONE;
  // For alpha, a factor of a colour is that of its alpha.
  blend.srcAlphaBlendFactor = blend.srcColorBlendFactor;
  blend.dstAlphaBlendFactor = blend.dstColorBlendFactor;
  return blend;
}

}  // namespace

VertexTypes vertex_types(const HostBatch *host)
{
  VertexTypes types{};
  for (std::size_t i = 0; i < vertex_stream_count; i++) {
    const bool is_host = host && host->stream(VertexStream(i)).buffer != 0;
    types[i] = is_host ? host->stream(VertexStream(i)).type : vertex_formats()[i].type;
  }
  return types;
}

VkFormat vertex_format(int component_count, VertexType type)
{
  // Formats of two, three and four components.
  constexpr std::array<std::array<VkFormat, 3>, 6> formats = {{
      {VK_FORMAT_R32G32_SFLOAT, VK_FORMAT_R32G32B32_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT},
      {VK_FORMAT_R16G16_SFLOAT, VK_FORMAT_R16G16B16_SFLOAT, VK_FORMAT_R16G16B16A16_SFLOAT},
      {VK_FORMAT_R8G8_SNORM, VK_FORMAT_R8G8B8_SNORM, VK_FORMAT_R8G8B8A8_SNORM},
      {VK_FORMAT_R8G8_UNORM, VK_FORMAT_R8G8B8_UNORM, VK_FORMAT_R8G8B8A8_UNORM},
      {VK_FORMAT_R16G16_SNORM, VK_FORMAT_R16G16B16_SNORM, VK_FORMAT_R16G16B16A16_SNORM},
      {VK_FORMAT_R16G16_UNORM, VK_FORMAT_R16G16B16_UNORM, VK_FORMAT_R16G16B16A16_UNORM},
  }};
  static_assert(std::size_t(VertexType::Unorm16) + 1 == formats.size());
  return formats[std::size_t(type)][std::size_t(component_count - 2)];
}

std::uint32_t pipeline_state(State state)
{
  constexpr State kept = State::WriteColor | State::BlendAdd | State::BlendMultiply | State::BlendOver |
                         State::DepthClamp | State::DrawLines | State::DrawPoints | State::Wireframe;
  return std::uint32_t(state) & std::uint32_t(kept);
}

VulkanProgram::VulkanProgram(VulkanContext &context, std::string name, std::string variant,
                             const std::vector<SpirvStage> &stages, const std::vector<StageConstant> &constants)
    : context_(context), name_(std::move(name)), variant_(std::move(variant)), interface_(interface_of(name_, stages))
{
  try {
    create(stages, constants);
  }
  catch (...) {
    destroy();
    throw;
  }
}

VulkanProgram::~VulkanProgram()
{
  destroy();
}

void VulkanProgram::destroy()
{
  for (const auto &[key, pipeline] : pipelines_) {
    context_.vk.vkDestroyPipeline(context_.device, pipeline, nullptr);
  }
  context_.vk.vkDestroyPipelineLayout(context_.device, layout_, nullptr);
  context_.vk.vkDestroyDescriptorSetLayout(context_.device, set_layout_, nullptr);
  for (const VkPipelineShaderStageCreateInfo &stage : stages_) {
    context_.vk.vkDestroyShaderModule(context_.device, stage.module, nullptr);
  }
}

void VulkanProgram::create(const std::vector<SpirvStage> &stages, const std::vector<StageConstant> &constants)
{
  const std::string what = fmt::format("shader '{}'", name_);
  for (const SpirvStage &stage : stages) {
    VkShaderModuleCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO;
    info.codeSize = stage.words.size() * sizeof(std::uint32_t);
    info.pCode = stage.words.data();
    VkPipelineShaderStageCreateInfo made{};
    made.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    made.stage = vulkan_stage(stage.stage);
    made.pName = "main";
    context_.check(context_.vk.vkCreateShaderModule(context_.device, &info, nullptr, &made.module), what);
    context_.label(VK_OBJECT_TYPE_SHADER_MODULE, made.module, name_);
    Constants &set = constants_.emplace_back();
    for (const StageConstant &constant : constants) {
      if (constant.stage == stage.stage) {
        set.entries.push_back(
            {constant.id, std::uint32_t(set.values.size() * sizeof(constant.value)), sizeof(constant.value)});
        set.values.push_back(constant.value);
      }
    }
    if (!set.entries.empty()) {
      set.info = {std::uint32_t(set.entries.size()), set.entries.data(), set.values.size() * sizeof(std::int32_t),
                  set.values.data()};
      made.pSpecializationInfo = &set.info;
    }
    stages_.push_back(made);
  }
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const VulkanBinding &binding : interface_.bindings) {
    bindings.push_back({binding.slot, binding.type, 1, binding.stages, nullptr});
  }
  VkDescriptorSetLayoutCreateInfo set{};
  set.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO;
  set.bindingCount = std::uint32_t(bindings.size());
  set.pBindings = bindings.data();
  context_.check(context_.vk.vkCreateDescriptorSetLayout(context_.device, &set, nullptr, &set_layout_), what);
  context_.label(VK_OBJECT_TYPE_DESCRIPTOR_SET_LAYOUT, set_layout_, name_);
  // The same range in all programs, so that push constants stay when another program is bound.
  const VkPushConstantRange range{VK_SHADER_STAGE_ALL_GRAPHICS, 0, push_constant_bytes};
  VkPipelineLayoutCreateInfo layout{};
  layout.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO;
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &set_layout_;
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &range;
  context_.check(context_.vk.vkCreatePipelineLayout(context_.device, &layout, nullptr, &layout_), what);
  context_.label(VK_OBJECT_TYPE_PIPELINE_LAYOUT, layout_, name_);
}

std::pair<VkPipeline, bool> VulkanProgram::pipeline(const PipelineKey &key)
{
  const auto [made, is_new] = pipelines_.try_emplace(key, VK_NULL_HANDLE);
  if (is_new) {
    try {
      made->second = make(key);
    }
    catch (...) {
      pipelines_.erase(made);
      throw;
    }
  }
  return {made->second, is_new};
}

VkPipeline VulkanProgram::make(const PipelineKey &key)
{
  const trace::Span span("make pipeline", variant_);
  const auto state = State(key.state);
  const VertexInputs inputs =
      key.is_procedural ? VertexInputs() : vertex_inputs(interface_.vertex_inputs, key.has_objects, key.vertex_types);
  VkPipelineVertexInputStateCreateInfo vertices{};
  vertices.sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO;
  vertices.vertexBindingDescriptionCount = std::uint32_t(inputs.bindings.size());
  vertices.pVertexBindingDescriptions = inputs.bindings.data();
  vertices.vertexAttributeDescriptionCount = std::uint32_t(inputs.attributes.size());
  vertices.pVertexAttributeDescriptions = inputs.attributes.data();
  VkPipelineInputAssemblyStateCreateInfo assembly{};
  assembly.sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO;
  assembly.topology = has(state, State::DrawPoints)  ? VK_PRIMITIVE_TOPOLOGY_POINT_LIST
                      : has(state, State::DrawLines) ? VK_PRIMITIVE_TOPOLOGY_LINE_LIST
                                                     : VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  VkPipelineViewportStateCreateInfo viewport{};
  viewport.sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO;
  viewport.viewportCount = 1;
  viewport.scissorCount = 1;
  // Flat outputs are those of the last vertex, as in OpenGL.
  VkPipelineRasterizationProvokingVertexStateCreateInfoEXT provoking{};
  provoking.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_PROVOKING_VERTEX_STATE_CREATE_INFO_EXT;
  provoking.provokingVertexMode = VK_PROVOKING_VERTEX_MODE_LAST_VERTEX_EXT;
  VkPipelineRasterizationStateCreateInfo rasterization{};
  rasterization.sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO;
  rasterization.pNext = &provoking;
  rasterization.depthClampEnable = has(state, State::DepthClamp) ? VK_TRUE : VK_FALSE;
  rasterization.polygonMode = has(state, State::Wireframe) ? VK_POLYGON_MODE_LINE : VK_POLYGON_MODE_FILL;
  rasterization.lineWidth = 1.0F;
  VkPipelineMultisampleStateCreateInfo samples{};
  samples.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO;
  samples.rasterizationSamples = key.samples;
  VkPipelineDepthStencilStateCreateInfo depth{};
  depth.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO;
  const auto color_count = std::uint32_t(std::ranges::find(key.colors, VK_FORMAT_UNDEFINED) - key.colors.begin());
  const std::vector<VkPipelineColorBlendAttachmentState> blends(color_count, blending(state));
  VkPipelineColorBlendStateCreateInfo blend{};
  blend.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO;
  blend.attachmentCount = color_count;
  blend.pAttachments = blends.data();
  std::vector<VkDynamicState> dynamics = {
      VK_DYNAMIC_STATE_VIEWPORT,         VK_DYNAMIC_STATE_SCISSOR,           VK_DYNAMIC_STATE_CULL_MODE,
      VK_DYNAMIC_STATE_FRONT_FACE,       VK_DYNAMIC_STATE_DEPTH_TEST_ENABLE, VK_DYNAMIC_STATE_DEPTH_WRITE_ENABLE,
      VK_DYNAMIC_STATE_DEPTH_COMPARE_OP, VK_DYNAMIC_STATE_DEPTH_BIAS_ENABLE, VK_DYNAMIC_STATE_DEPTH_BIAS,
  };
  if (!inputs.bindings.empty()) {
    dynamics.push_back(VK_DYNAMIC_STATE_VERTEX_INPUT_BINDING_STRIDE);
  }
  VkPipelineDynamicStateCreateInfo dynamic{};
  dynamic.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO;
  dynamic.dynamicStateCount = std::uint32_t(dynamics.size());
  dynamic.pDynamicStates = dynamics.data();
  VkPipelineRenderingCreateInfo rendering{};
  rendering.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO;
  rendering.colorAttachmentCount = color_count;
  rendering.pColorAttachmentFormats = key.colors.data();
  rendering.depthAttachmentFormat = key.depth;
  VkGraphicsPipelineCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO;
  info.pNext = &rendering;
  info.stageCount = std::uint32_t(stages_.size());
  info.pStages = stages_.data();
  info.pVertexInputState = &vertices;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &rasterization;
  info.pMultisampleState = &samples;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blend;
  info.pDynamicState = &dynamic;
  info.layout = layout_;
  VkPipeline pipeline = VK_NULL_HANDLE;
  context_.check(context_.vk.vkCreateGraphicsPipelines(context_.device, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
                 fmt::format("shader '{}'", name_));
  context_.label(VK_OBJECT_TYPE_PIPELINE, pipeline, name_);
  return pipeline;
}

}  // namespace gnomon::gpu
