// SPDX-License-Identifier: MIT
#include "vulkan_submission.hh"

#include <limits>
#include <utility>

namespace gnomon::gpu {

VulkanSubmissions::VulkanSubmissions(VulkanContext &context) : context_(context)
{
  VkCommandPoolCreateInfo pool{};
  pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
  pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
  pool.queueFamilyIndex = context.queue_family;
  context.check(context.vk.vkCreateCommandPool(context.device, &pool, nullptr, &pool_), "Vulkan");
  VkSemaphoreTypeCreateInfo type{};
  type.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO;
  type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
  const VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, &type, 0};
  const VkResult result = context.vk.vkCreateSemaphore(context.device, &semaphore, nullptr, &timeline_);
  if (result != VK_SUCCESS) {
    context.vk.vkDestroyCommandPool(context.device, pool_, nullptr);
    context.check(result, "Vulkan");
  }
}

VulkanSubmissions::~VulkanSubmissions()
{
  end();
  context_.vk.vkDestroySemaphore(context_.device, timeline_, nullptr);
  context_.vk.vkDestroyCommandPool(context_.device, pool_, nullptr);
}

VkCommandBuffer VulkanSubmissions::commands()
{
  if (open_ != VK_NULL_HANDLE) {
    return open_;
  }
  context_.check_lost("submit");
  collect();
  if (unused_.empty()) {
    VkCommandBufferAllocateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    info.commandPool = pool_;
    info.commandBufferCount = 1;
    VkCommandBuffer buffer = VK_NULL_HANDLE;
    context_.check(context_.vk.vkAllocateCommandBuffers(context_.device, &info, &buffer), "submit");
    unused_.push_back(buffer);
  }
  VkCommandBufferBeginInfo begin{};
  begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  context_.check(context_.vk.vkBeginCommandBuffer(unused_.back(), &begin), "submit");
  open_ = unused_.back();
  unused_.pop_back();
  return open_;
}

namespace {

VkSemaphoreSubmitInfo submit_info(VkSemaphore semaphore, std::uint64_t value)
{
  VkSemaphoreSubmitInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO;
  info.semaphore = semaphore;
  info.value = value;
  info.stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  return info;
}

void add(std::vector<VkSemaphoreSubmitInfo> &semaphores, const HostSemaphore &semaphore)
{
  if (semaphore.semaphore) {
    semaphores.push_back(submit_info(semaphore.semaphore, semaphore.value));
  }
}

}  // namespace

void VulkanSubmissions::wait_for(const HostSemaphore &semaphore)
{
  add(waits_, semaphore);
}

void VulkanSubmissions::signal(const HostSemaphore &semaphore)
{
  add(signals_, semaphore);
}

void VulkanSubmissions::flush()
{
  if (open_ == VK_NULL_HANDLE) {
    return;
  }
  const VkCommandBuffer buffer = std::exchange(open_, VK_NULL_HANDLE);
  const std::uint64_t number = number_++;
  running_.push_back({number, buffer});
  const VkResult recorded = context_.vk.vkEndCommandBuffer(buffer);
  VkCommandBufferSubmitInfo commands{};
  commands.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO;
  commands.commandBuffer = buffer;
  const std::vector<VkSemaphoreSubmitInfo> waits = std::exchange(waits_, {});
  std::vector<VkSemaphoreSubmitInfo> signals = std::exchange(signals_, {});
  signals.push_back(submit_info(timeline_, number));
  VkSubmitInfo2 info{};
  info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2;
  info.commandBufferInfoCount = 1;
  info.pCommandBufferInfos = &commands;
  info.waitSemaphoreInfoCount = std::uint32_t(waits.size());
  info.pWaitSemaphoreInfos = waits.data();
  info.signalSemaphoreInfoCount = std::uint32_t(signals.size());
  info.pSignalSemaphoreInfos = signals.data();
  // The layouts of images are known only if all submissions are executed, so that a device without one is lost.
  if (recorded != VK_SUCCESS || context_.submit(info) != VK_SUCCESS) {
    context_.check(VK_ERROR_DEVICE_LOST, "submit");
  }
  accepted_ = number;
}

void VulkanSubmissions::wait(std::uint64_t number)
{
  // A device that refused a submission never finishes it.
  context_.check_lost("wait");
  context_.check(wait_result(number), "wait");
}

VkResult VulkanSubmissions::wait_result(std::uint64_t number)
{
  VkSemaphoreWaitInfo info{};
  info.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO;
  info.semaphoreCount = 1;
  info.pSemaphores = &timeline_;
  info.pValues = &number;
  return context_.vk.vkWaitSemaphores(context_.device, &info, std::numeric_limits<std::uint64_t>::max());
}

void VulkanSubmissions::finish()
{
  flush();
  wait(number_ - 1);
  collect();
}

void VulkanSubmissions::end()
{
  // A lost device has finished, too.
  static_cast<void>(wait_result(accepted_));
  for (const Retired &retired : std::exchange(retired_, {})) {
    retired.destroy();
  }
}

std::uint64_t VulkanSubmissions::done()
{
  std::uint64_t done = 0;
  context_.note_lost(context_.vk.vkGetSemaphoreCounterValue(context_.device, timeline_, &done));
  return done;
}

void VulkanSubmissions::retire(std::function<void()> destroy)
{
  const bool is_open = open_ != VK_NULL_HANDLE;
  retired_.push_back({is_open ? number_ : number_ - 1, std::move(destroy)});
  // So that resources which no submission uses are destroyed without one.
  if (!is_open) {
    collect();
  }
}

void VulkanSubmissions::collect()
{
  const std::uint64_t finished = done();
  while (!running_.empty() && running_.front().number <= finished) {
    unused_.push_back(running_.front().buffer);
    running_.pop_front();
  }
  while (!retired_.empty() && retired_.front().number <= finished) {
    retired_.front().destroy();
    retired_.pop_front();
  }
}

}  // namespace gnomon::gpu
