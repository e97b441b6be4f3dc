// SPDX-License-Identifier: MIT
#include "vulkan/vulkan_memory.hh"

#include <gtest/gtest.h>

namespace gnomon::gpu {
namespace {

constexpr VkMemoryPropertyFlags LOCAL = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
constexpr VkMemoryPropertyFlags VISIBLE = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT;
constexpr VkMemoryPropertyFlags COHERENT = VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
constexpr VkMemoryPropertyFlags CACHED = VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
constexpr VkMemoryPropertyFlags LAZY = VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT;

using Types = std::vector<std::uint32_t>;

VkPhysicalDeviceMemoryProperties properties_of(const std::vector<VkMemoryPropertyFlags> &types)
{
  VkPhysicalDeviceMemoryProperties properties{};
  for (const VkMemoryPropertyFlags flags : types) {
    properties.memoryTypes[properties.memoryTypeCount++].propertyFlags = flags;
  }
  return properties;
}

constexpr std::uint32_t ALL = ~std::uint32_t(0);

TEST(VulkanMemoryTypes, OfAGraphicsCard)
{
  const auto properties = properties_of(
      {0, LOCAL, VISIBLE | COHERENT, VISIBLE | COHERENT | CACHED, LOCAL | VISIBLE | COHERENT, LOCAL | LAZY});
  EXPECT_EQ(memory_types_of(properties, ALL, MemoryUse::Device).front(), 1U);
  EXPECT_EQ(memory_types_of(properties, ALL, MemoryUse::Upload).front(), 2U);
  EXPECT_EQ(memory_types_of(properties, ALL, MemoryUse::Readback).front(), 3U);
}

TEST(VulkanMemoryTypes, OnlyThoseThatTheResourceAllowsAndTheCpuSees)
{
  const auto properties = properties_of({LOCAL, VISIBLE | COHERENT, VISIBLE | CACHED, LOCAL | VISIBLE});
  EXPECT_EQ(memory_types_of(properties, 0b1101, MemoryUse::Upload), (Types{3, 2}));
  EXPECT_EQ(memory_types_of(properties, 0b0001, MemoryUse::Readback), Types());
  // Where the best one is full, the others follow.
  EXPECT_EQ(memory_types_of(properties, ALL, MemoryUse::Device).size(), 4U);
}

TEST(VulkanMemoryTypes, OfADeviceOnTheCpu)
{
  const auto properties = properties_of({LOCAL | VISIBLE | COHERENT | CACHED});
  for (const MemoryUse use : {MemoryUse::Device, MemoryUse::Upload, MemoryUse::Readback}) {
    EXPECT_EQ(memory_types_of(properties, ALL, use), Types{0});
  }
}

TEST(VulkanMemoryRanges, AreWholeAtomsThatEndWithTheMemory)
{
  EXPECT_EQ(whole_atoms({0, 1}, 64, 1000), (MemoryRange{0, 64}));
  EXPECT_EQ(whole_atoms({63, 2}, 64, 1000), (MemoryRange{0, 128}));
  EXPECT_EQ(whole_atoms({128, 64}, 64, 1000), (MemoryRange{128, 64}));
  EXPECT_EQ(whole_atoms({990, 5}, 64, 1000), (MemoryRange{960, 40}));
  EXPECT_EQ(whole_atoms({7, 5}, 1, 1000), (MemoryRange{7, 5}));
}

}  // namespace
}  // namespace gnomon::gpu
