// SPDX-License-Identifier: MIT
#pragma once

#include "vulkan_context.hh"

#include "gpu_shader.hh"

#include <vector>

namespace gnomon::gpu {

/** A block or a texture that a program declares. The slot is the binding in the only descriptor set. */
struct VulkanBinding {
  std::uint32_t slot = 0;
  VkDescriptorType type = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
  VkShaderStageFlags stages = 0;
  /** Whether a texture is an array, and whether it compares depths. */
  bool is_array = false;
  bool is_comparison = false;
};

/** Bindings and vertex inputs of a program. */
struct SpirvInterface {
  /** By slot. */
  std::vector<VulkanBinding> bindings;
  /** Mask of the locations of the vertex stage's inputs. */
  std::uint32_t vertex_inputs = 0;
};

[[nodiscard]] VkShaderStageFlagBits vulkan_stage(ShaderStage stage);

/** Reads the interface from valid SPIR-V. \throws Error that names the shader \a name if a slot has two kinds */
[[nodiscard]] SpirvInterface interface_of(std::string_view name, const std::vector<SpirvStage> &stages);

/** The form of the cache on disk. */
[[nodiscard]] std::vector<std::byte> packed(const std::vector<SpirvStage> &stages);
/** Empty if \a bytes is no result of packed(). */
[[nodiscard]] std::vector<SpirvStage> unpacked(const std::vector<std::byte> &bytes);

}  // namespace gnomon::gpu
