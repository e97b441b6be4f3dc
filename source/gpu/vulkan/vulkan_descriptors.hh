// SPDX-License-Identifier: MIT
#pragma once

#include "vulkan_submission.hh"

#include <deque>
#include <vector>

namespace gnomon::gpu {

/** Descriptor sets for the open submission, from pools that later submissions use again. */
class VulkanDescriptors {
 public:
  VulkanDescriptors(VulkanContext &context, VulkanSubmissions &submissions);
  ~VulkanDescriptors();
  VulkanDescriptors(const VulkanDescriptors &) = delete;
  VulkanDescriptors &operator=(const VulkanDescriptors &) = delete;

  /** Valid until the open submission is submitted. */
  [[nodiscard]] VkDescriptorSet allocate(VkDescriptorSetLayout layout);
  /** Destroy the pools that no submission in work uses. \return whether there was one */
  bool trim();

 private:
  struct Pool {
    VkDescriptorPool handle = VK_NULL_HANDLE;
    /** The last submission that uses its sets. */
    std::uint64_t number = 0;
    std::uint32_t set_count = 0;
  };
  void add_pool();

  VulkanContext &context_;
  VulkanSubmissions &submissions_;
  /** Oldest first. Sets come from the last one. */
  std::deque<Pool> pools_;
};

}  // namespace gnomon::gpu
