// SPDX-License-Identifier: MIT
#include "vulkan_descriptors.hh"

#include <array>

namespace gnomon::gpu {

namespace {

/** Sets in a pool. */
constexpr std::uint32_t set_count_max = 128;

}  // namespace

VulkanDescriptors::VulkanDescriptors(VulkanContext &context, VulkanSubmissions &submissions)
    : context_(context), submissions_(submissions)
{
}

VulkanDescriptors::~VulkanDescriptors()
{
  for (const Pool &pool : pools_) {
    context_.vk.vkDestroyDescriptorPool(context_.device, pool.handle, nullptr);
  }
}

VkDescriptorSet VulkanDescriptors::allocate(VkDescriptorSetLayout layout)
{
  VkDescriptorSet set = VK_NULL_HANDLE;
  VkDescriptorSetAllocateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO;
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  VkResult result = VK_ERROR_OUT_OF_POOL_MEMORY;
  for (int attempt = 0; attempt < 2 && (result == VK_ERROR_OUT_OF_POOL_MEMORY || result == VK_ERROR_FRAGMENTED_POOL);
       attempt++) {
    // A pool may give more sets than it is made for, as lavapipe's do, and then has no end.
    if (attempt == 1 || pools_.empty() || pools_.back().set_count == set_count_max) {
      add_pool();
    }
    info.descriptorPool = pools_.back().handle;
    result = context_.vk.vkAllocateDescriptorSets(context_.device, &info, &set);
  }
  context_.check(result, "submit: bindings");
  pools_.back().set_count++;
  pools_.back().number = submissions_.number();
  return set;
}

bool VulkanDescriptors::trim()
{
  const std::uint64_t done = submissions_.done();
  return std::erase_if(pools_, [&](const Pool &pool) {
           const bool is_unused = pool.number <= done;
           if (is_unused) {
             context_.vk.vkDestroyDescriptorPool(context_.device, pool.handle, nullptr);
           }
           return is_unused;
         }) > 0;
}

void VulkanDescriptors::add_pool()
{
  if (!pools_.empty() && pools_.front().number <= submissions_.done()) {
    Pool pool = pools_.front();
    context_.check(context_.vk.vkResetDescriptorPool(context_.device, pool.handle, 0), "submit: bindings");
    pools_.pop_front();
    pool.set_count = 0;
    pools_.push_back(pool);
    return;
  }
  // Per set, as the engines' largest programs have them; smaller ones leave room for more sets.
  constexpr std::array<VkDescriptorPoolSize, 4> sizes = {
      {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, set_count_max * 8},
       {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, set_count_max * 5},
       {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, set_count_max * 30},
       {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, set_count_max * 4}}};
  VkDescriptorPoolCreateInfo info{};
  info.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO;
  info.maxSets = set_count_max;
  info.poolSizeCount = std::uint32_t(sizes.size());
  info.pPoolSizes = sizes.data();
  Pool pool;
  context_.check(context_.vk.vkCreateDescriptorPool(context_.device, &info, nullptr, &pool.handle), "submit: bindings");
  pools_.push_back(pool);
}

}  // namespace gnomon::gpu
