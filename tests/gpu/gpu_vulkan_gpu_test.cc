// SPDX-License-Identifier: MIT
// What the tests of all backends do not show of Vulkan's. These need no GNOMON_TEST_BACKEND.
#include "gpu/gpu_testing.hh"
#include "gpu_device_fixture.hh"

#include "vulkan/vulkan_images.hh"
#include "vulkan/vulkan_submission.hh"

#include <regex>

namespace gnomon::gpu {
namespace {

class VulkanGpu : public testing::Test {
 protected:
  void SetUp() override
  {
    device = test::testing_device("vulkan");
    if (!device && !HasFailure()) {
      GTEST_SKIP();
    }
    ASSERT_TRUE(device);
  }
  std::vector<glm::vec4> drawn(Device &on, float value) const
  {
    const Texture picture = on.create_texture({.name = "p", .format = Format::RGBA32F, .width = 2, .height = 2});
    const Framebuffer framebuffer = on.create_framebuffer({"p", {{&picture}}, {}});
    CommandList list;
    list.begin_pass("p", framebuffer, {.clear_color = glm::vec4(value)});
    list.end_pass();
    on.submit(list);
    return read_as<glm::vec4>(on, picture);
  }

  std::unique_ptr<Device> device;
};

TEST_F(VulkanGpu, DescribesItselfInOneLine)
{
  EXPECT_TRUE(std::regex_match(device->description(), std::regex("Vulkan 1\\.[0-9]+\\.[0-9]+, .+ \\(.+\\)")))
      << device->description();
}

TEST_F(VulkanGpu, DevicesStandBesideEachOther)
{
  const auto other = test::testing_device("vulkan");
  ASSERT_TRUE(other);
  EXPECT_EQ(drawn(*device, 1), std::vector<glm::vec4>(4, glm::vec4(1)));
  EXPECT_EQ(drawn(*other, 2), std::vector<glm::vec4>(4, glm::vec4(2)));
  EXPECT_EQ(drawn(*device, 3), std::vector<glm::vec4>(4, glm::vec4(3)));
}

TEST_F(VulkanGpu, WhatIsOfAHostIsRefusedByName)
{
  const auto refused = [&](auto &&action) { return test::error_of(action); };
  test::expect_contains(
      refused([&] {
        static_cast<void>(device->create_texture(texture_desc("theirs", HostTexture{.name = 1, .size_px = {1, 1}})));
      }),
      "texture 'theirs'");
  const HostStream stream{.buffer = 1, .stride_bytes = 12};
  test::expect_contains(refused([&] {
                          static_cast<void>(device->create_batch(
                              "theirs", HostBatch{.positions = stream, .vertex_count = 3, .index_buffer = 1}));
                        }),
                        "batch 'theirs'");
  CommandList list;
  list.begin_pass("onto theirs", HostFramebuffer{.name = 1, .size_px = {4, 4}}, {});
  list.end_pass();
  test::expect_contains(refused([&] { device->submit(list); }), "pass 'onto theirs'");
  EXPECT_EQ(drawn(*device, 3), std::vector<glm::vec4>(4, glm::vec4(3)));
}

TEST_F(VulkanGpu, SrgbAttachmentsEncodeOnlyInPassesThatAskForIt)
{
  const Texture picture = device->create_texture({.name = "p", .format = Format::SRGB8A8, .width = 1, .height = 1});
  const Framebuffer framebuffer = device->create_framebuffer({"p", {{&picture}}, {}});
  const Shader shader = test::make_shader(*device, "color", test::CLIP_SPACE_VERT, test::COLOR_FRAG);
  const Batch full = test::full_triangle(*device, 0.5F);
  for (const bool is_encoded : {true, false}) {
    CommandList list;
    list.begin_pass("p", framebuffer, {.is_srgb_encoded = is_encoded});
    list.set_shader(shader.id());
    list.set_state(State::WriteColor);
    test::push_constants(list, shader, glm::vec4(0.5F, 0.5F, 0.5F, 1));
    test::append_draw(list, full);
    list.end_pass();
    device->submit(list);
    // Half of the light is 188 of 255 in sRGB.
    EXPECT_NEAR(int(read_as<std::uint8_t>(*device, picture)[0]), is_encoded ? 188 : 128, 1);
  }
}

TEST_F(VulkanGpu, APassThatReadsItsAttachmentReadsWhatWasThereBefore)
{
  const Texture picture = device->create_texture({.name = "p", .format = Format::RGBA32F, .width = 4, .height = 4});
  const Framebuffer framebuffer = device->create_framebuffer({"p", {{&picture}}, {}});
  const Sampler sampler = device->create_sampler({.name = "nearest"});
  const Shader shader = test::make_shader(*device, "double", test::CLIP_SPACE_VERT, R"(
layout(binding = 16) uniform sampler2D before;
layout(location = 0) out vec4 result;
void main()
{
  result = 2.0 * texelFetch(before, ivec2(gl_FragCoord.xy), 0);
})");
  const Batch full = test::full_triangle(*device, 0.5F);
  CommandList list;
  list.begin_pass("clear", framebuffer, {.clear_color = glm::vec4(3)});
  list.end_pass();
  for (int i = 0; i < 3; i++) {
    list.begin_pass("double", framebuffer, {.color_load = LoadAction::Load, .reads_attachments = true});
    list.set_shader(shader.id());
    list.set_state(State::WriteColor);
    list.bind_texture(16, picture.id(), sampler.id());
    test::append_draw(list, full);
    list.end_pass();
  }
  device->submit(list);
  EXPECT_EQ(read_as<glm::vec4>(*device, picture), std::vector<glm::vec4>(16, glm::vec4(24)));
}

/** The checks of synchronisation are on: without a barrier between two copies, they report the second. */
TEST(VulkanValidation, FindsAMissingBarrier)
{
  std::unique_ptr<VulkanContext> context;
  const std::string reason =
      test::error_of([&] { context = std::make_unique<VulkanContext>(true, [](std::string_view /*message*/) {}); });
  if (!context) {
    GTEST_SKIP() << reason;
  }
  for (const bool has_barrier : {true, false}) {
    VulkanMemory memory(*context);
    const VulkanBuffer buffer = memory.make_buffer("buffer", 256, VK_BUFFER_USAGE_TRANSFER_DST_BIT, MemoryUse::Device);
    {
      VulkanSubmissions submissions(*context);
      VulkanBarriers barriers(*context);
      VkCommandBuffer commands = submissions.commands();
      for (std::uint32_t i = 0; i < 2; i++) {
        if (has_barrier) {
          barriers.before_copy(VK_NULL_HANDLE, buffer.handle);
          barriers.record(commands);
        }
        context->vk.vkCmdFillBuffer(commands, buffer.handle, 0, VK_WHOLE_SIZE, i);
      }
      submissions.finish();
    }
    memory.destroy(buffer);
    const std::string message = test::error_of([&] { context->check_messages("fills"); });
    EXPECT_EQ(message.find("SYNC-HAZARD-WRITE-AFTER-WRITE") != std::string::npos, !has_barrier) << message;
  }
}

}  // namespace
}  // namespace gnomon::gpu
