// SPDX-License-Identifier: MIT
#pragma once

#define VK_NO_PROTOTYPES
#include <vulkan/vulkan.h>

#include <vector>

namespace gnomon::test {

/** Has \a function record the barriers of \a info, but they order nothing and change only layouts. */
inline void record_weak_barrier(PFN_vkCmdPipelineBarrier2 function, VkCommandBuffer commands,
                                const VkDependencyInfo &info)
{
  std::vector<VkImageMemoryBarrier2> images(info.pImageMemoryBarriers,
                                            info.pImageMemoryBarriers + info.imageMemoryBarrierCount);
  for (VkImageMemoryBarrier2 &image : images) {
    image.srcStageMask = image.dstStageMask = VK_PIPELINE_STAGE_2_NONE;
    image.srcAccessMask = image.dstAccessMask = VK_ACCESS_2_NONE;
  }
  VkDependencyInfo weak = info;
  weak.memoryBarrierCount = 0;
  weak.pImageMemoryBarriers = images.data();
  function(commands, &weak);
}

}  // namespace gnomon::test
