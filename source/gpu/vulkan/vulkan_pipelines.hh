// SPDX-License-Identifier: MIT
#pragma once

#include "vulkan_shaders.hh"

#include "gpu_batch.hh"
#include "gpu_state.hh"

#include <array>
#include <compare>
#include <deque>
#include <map>
#include <string>
#include <utility>

namespace gnomon::gpu {

/** Types of the components of all vertex streams. */
using VertexTypes = std::array<VertexType, vertex_stream_count>;
/** The types of batches in the shared buffers, or of \a host. */
[[nodiscard]] VertexTypes vertex_types(const HostBatch *host = nullptr);

[[nodiscard]] VkFormat vertex_format(int component_count, VertexType type);

/** State that is compiled into a pipeline of a program; the rest is dynamic. */
struct PipelineKey {
  static constexpr std::size_t color_count_max = 8;
  /** The part of State that cannot be dynamic. */
  std::uint32_t state = 0;
  /** VK_FORMAT_UNDEFINED: there is no such attachment. */
  std::array<VkFormat, color_count_max> colors{};
  VkFormat depth = VK_FORMAT_UNDEFINED;
  VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
  /** Draws take vertices from no buffer, or instances from a buffer of objects. */
  bool is_procedural = false;
  bool has_objects = false;
  VertexTypes vertex_types{};

  auto operator<=>(const PipelineKey &) const = default;
};

/** The bits of \a state that a pipeline is made for. */
[[nodiscard]] std::uint32_t pipeline_state(State state);

/** Push constants of all programs: as many bytes as each device supports. */
inline constexpr std::uint32_t push_constant_bytes = 128;

/** A program with its pipelines. */
class VulkanProgram {
 public:
  /** \a variant: the name with the defines, for traces. \throws Error that names the shader \a name */
  VulkanProgram(VulkanContext &context, std::string name, std::string variant, const std::vector<SpirvStage> &stages,
                const std::vector<StageConstant> &constants);
  ~VulkanProgram();
  VulkanProgram(const VulkanProgram &) = delete;
  VulkanProgram &operator=(const VulkanProgram &) = delete;

  /** The pipeline of \a key, and whether this call made it, as the first one does. \throws Error */
  [[nodiscard]] std::pair<VkPipeline, bool> pipeline(const PipelineKey &key);
  [[nodiscard]] VkPipelineLayout layout() const
  {
    return layout_;
  }
  [[nodiscard]] VkDescriptorSetLayout set_layout() const
  {
    return set_layout_;
  }
  [[nodiscard]] const SpirvInterface &interface() const
  {
    return interface_;
  }

 private:
  void create(const std::vector<SpirvStage> &stages, const std::vector<StageConstant> &constants);
  void destroy();
  [[nodiscard]] VkPipeline make(const PipelineKey &key);

  VulkanContext &context_;
  std::string name_;
  std::string variant_;
  SpirvInterface interface_;
  std::vector<VkPipelineShaderStageCreateInfo> stages_;
  /** Values of the specialisation constants of a stage. `stages_` points to them. */
  struct Constants {
    std::vector<VkSpecializationMapEntry> entries;
    std::vector<std::int32_t> values;
    VkSpecializationInfo info{};
  };
  std::deque<Constants> constants_;
  VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
  VkPipelineLayout layout_ = VK_NULL_HANDLE;
  std::map<PipelineKey, VkPipeline> pipelines_;
};

}  // namespace gnomon::gpu
