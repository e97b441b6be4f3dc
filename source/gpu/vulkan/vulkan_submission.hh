// SPDX-License-Identifier: MIT
#pragma once

#include "vulkan_context.hh"

#include <deque>
#include <functional>
#include <vector>

namespace gnomon::gpu {

/**
 * Submissions to the queue, in order. Commands are recorded into the open one. A timeline semaphore counts those that
 * the device has finished; the resources of a submission are freed after that.
 */
class VulkanSubmissions {
 public:
  explicit VulkanSubmissions(VulkanContext &context);
  ~VulkanSubmissions();
  VulkanSubmissions(const VulkanSubmissions &) = delete;
  VulkanSubmissions &operator=(const VulkanSubmissions &) = delete;

  /** The command buffer of the open submission, which begins if there is none. */
  [[nodiscard]] VkCommandBuffer commands();
  /** Number of the open submission, or of the next one. */
  [[nodiscard]] std::uint64_t number() const
  {
    return number_;
  }
  /** The open submission, or the next one, waits for a semaphore of the host before it begins. */
  void wait_for(const HostSemaphore &semaphore);
  /** It signals a semaphore of the host after all its work. */
  void signal(const HostSemaphore &semaphore);
  /** Submit the open one. */
  void flush();
  /** Wait until the device has finished the submission \a number, which must be submitted. */
  void wait(std::uint64_t number);
  /** Submit the open one and wait for all. */
  void finish();
  /**
   * Wait for all that was submitted, also on a lost device, and destroy what was retired. Does not wait for the device,
   * because a host may be using its other queues.
   */
  void end();
  /** Number of the last submission that the device has finished; 0 if the device is lost. */
  [[nodiscard]] std::uint64_t done();
  /** Call \a destroy, which must not throw, after the device has finished the open submission and those before it. */
  void retire(std::function<void()> destroy);

 private:
  struct Commands {
    std::uint64_t number = 0;
    VkCommandBuffer buffer = VK_NULL_HANDLE;
  };
  struct Retired {
    std::uint64_t number = 0;
    std::function<void()> destroy;
  };
  [[nodiscard]] VkResult wait_result(std::uint64_t number);
  /** Destroys resources that the device no longer uses. */
  void collect();

  VulkanContext &context_;
  VkCommandPool pool_ = VK_NULL_HANDLE;
  VkSemaphore timeline_ = VK_NULL_HANDLE;
  std::uint64_t number_ = 1;
  /** Number of the last one that the device has accepted; 0: none. */
  std::uint64_t accepted_ = 0;
  /** Semaphores of the open submission. */
  std::vector<VkSemaphoreSubmitInfo> waits_;
  std::vector<VkSemaphoreSubmitInfo> signals_;
  VkCommandBuffer open_ = VK_NULL_HANDLE;
  std::deque<Commands> running_;
  std::vector<VkCommandBuffer> unused_;
  std::deque<Retired> retired_;
};

}  // namespace gnomon::gpu
