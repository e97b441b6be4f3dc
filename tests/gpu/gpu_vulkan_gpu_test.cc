// SPDX-License-Identifier: MIT
// Tests of Vulkan's backend alone. They do not need GNOMON_TEST_BACKEND.
#include "gpu/gpu_testing.hh"
#include "gpu/gpu_weak_barrier.hh"
#include "gpu_device_fixture.hh"

#include "gpu_swapchain.hh"
#include "vulkan/vulkan_device.hh"

#include <regex>

namespace gnomon::gpu {
namespace {

class VulkanGpu : public testing::Test {
 protected:
  void SetUp() override
  {
    device = test::testing_vulkan_device();
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
  const auto other = test::testing_vulkan_device();
  ASSERT_TRUE(other);
  EXPECT_EQ(drawn(*device, 1), std::vector<glm::vec4>(4, glm::vec4(1)));
  EXPECT_EQ(drawn(*other, 2), std::vector<glm::vec4>(4, glm::vec4(2)));
  EXPECT_EQ(drawn(*device, 3), std::vector<glm::vec4>(4, glm::vec4(3)));
}

TEST_F(VulkanGpu, ADeviceWithoutValidationLeavesThatOfOthers)
{
  {
    const auto other = create_vulkan_device({.compile_spirv = shader_check::compile_spirv});
    EXPECT_EQ(drawn(*other, 2), std::vector<glm::vec4>(4, glm::vec4(2)));
  }
  // Names its image, and ends, by functions that the other instance did not have.
  EXPECT_EQ(drawn(*device, 1), std::vector<glm::vec4>(4, glm::vec4(1)));
  device.reset();
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

TEST_F(VulkanGpu, ASwapchainNeedsAWindow)
{
  test::expect_contains(test::error_of([&] { static_cast<void>(create_swapchain(*device, true)); }),
                        "swapchain: the device is not made for a window");
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

TEST_F(VulkanGpu, ATextIsCompiledOnceForAllValuesOfItsConstants)
{
  std::string folder = (std::filesystem::temp_directory_path() / "gnomon_constants.XXXXXX").string();
  ASSERT_TRUE(mkdtemp(folder.data()));
  int compiled_count = 0;
  const auto compile = [&](std::string_view name, const std::vector<ShaderSource> &stages) {
    compiled_count++;
    return shader_check::compile_spirv(name, stages);
  };
  {
    const auto other = create_vulkan_device({.compile_spirv = compile, .shader_cache_folder = folder});
    for (const std::int32_t value : {0, 1, 2}) {
      test::make_shader(*other, "constants", test::CLIP_SPACE_VERT,
                        std::string("SPECIALIZATION_CONSTANT(0) const int taps = 4;") + test::COLOR_FRAG, "",
                        {{"taps", value}});
    }
    EXPECT_EQ(other->counters().shaders_from_cache, 2U);
  }
  EXPECT_EQ(compiled_count, 1);
  std::filesystem::remove_all(folder);
}

TEST(VulkanDevice, WithoutACompilerOfShadersIsAnError)
{
  test::expect_contains(test::error_of([] { static_cast<void>(create_vulkan_device({})); }), "no compiler of shaders");
}

template <typename Function>
struct Failing;
/** A function of the driver that does nothing and fails. */
template <typename... Arguments>
struct Failing<VkResult(VKAPI_PTR *)(Arguments...)> {
  static inline VkResult result = VK_SUCCESS;
  static VkResult VKAPI_PTR call(Arguments... /*arguments*/)
  {
    return result;
  }
};

/** A device whose driver fails on demand. */
class VulkanFailure : public testing::Test {
 protected:
  void SetUp() override
  {
    if (test::testing_vulkan_device()) {
      make();
    }
    else if (!HasFailure()) {
      GTEST_SKIP();
    }
    ASSERT_TRUE(device);
  }
  void make()
  {
    test::set_validation_options();
    auto made =
        std::make_unique<VulkanContext>(true, nullptr, [](std::string_view message) { ADD_FAILURE() << message; });
    context = made.get();
    device =
        std::make_unique<VulkanDevice>(std::move(made), VulkanDeviceDesc{.compile_spirv = shader_check::compile_spirv});
  }
  /** Makes one of each resource, draws, and reads the picture. */
  std::vector<glm::vec4> drawn(float value)
  {
    const Texture picture =
        device->create_texture({.name = "thing", .format = Format::RGBA32F, .width = 2, .height = 2});
    const Texture texels =
        device->create_texture({.name = "thing", .kind = TextureKind::Buffer, .format = Format::R32F, .width = 4});
    device->upload(texels, 0, std::as_bytes(std::span(&value, 1)));
    const Sampler sampler = device->create_sampler({.name = "thing"});
    const Framebuffer framebuffer = device->create_framebuffer({"thing", {{&picture}}, {}});
    const Shader shader = test::make_shader(*device, "thing", test::CLIP_SPACE_VERT, R"(
layout(binding = 16) uniform samplerBuffer texels;
layout(location = 0) out vec4 result;
void main()
{
  result = vec4(texelFetch(texels, 0).r);
})");
    const Batch full = test::full_triangle(*device, 0.5F);
    CommandList list;
    list.begin_pass("thing", framebuffer, {});
    list.set_shader(shader.id());
    list.set_state(State::WriteColor);
    list.bind_texture(16, texels.id(), sampler.id());
    test::append_draw(list, full);
    list.end_pass();
    const TimerQuery timer = device->create_timer_query("thing");
    device->time_begin(timer);
    device->submit(list);
    device->time_end(timer);
    static_cast<void>(device->take_seconds(timer));
    return read_as<glm::vec4>(*device, picture);
  }
  /** The error of drawn() while the function \a member of the driver fails with \a result. */
  template <typename Function>
  std::string error_if(Function VulkanDeviceTable::*member, VkResult result)
  {
    const Function real = std::exchange(context->vk.*member, &Failing<Function>::call);
    Failing<Function>::result = result;
    const std::string message = test::error_of([&] { drawn(7); });
    context->vk.*member = real;
    return message;
  }

  std::unique_ptr<Device> device;
  VulkanContext *context = nullptr;
};

TEST_F(VulkanFailure, AFailedCallIsAnErrorThatNamesTheThingAndTheDeviceRemainsUsable)
{
  const std::vector<glm::vec4> expected(4, glm::vec4(3));
  const auto fail = [&](auto member, const char *name) {
    for (const VkResult result : {VK_ERROR_OUT_OF_DEVICE_MEMORY, VK_ERROR_OUT_OF_HOST_MEMORY}) {
      const std::string message = error_if(member, result);
      test::expect_contains(message, name);
      test::expect_contains(message, "out of memory");
      EXPECT_EQ(drawn(3), expected);
    }
  };
  fail(&VulkanDeviceTable::vkCreateImage, "'thing'");
  fail(&VulkanDeviceTable::vkBindImageMemory, "'thing'");
  fail(&VulkanDeviceTable::vkCreateImageView, "'thing'");
  fail(&VulkanDeviceTable::vkCreateBufferView, "'thing'");
  fail(&VulkanDeviceTable::vkCreateSampler, "'thing'");
  fail(&VulkanDeviceTable::vkCreateShaderModule, "'thing'");
  fail(&VulkanDeviceTable::vkCreateDescriptorSetLayout, "'thing'");
  fail(&VulkanDeviceTable::vkCreatePipelineLayout, "'thing'");
  fail(&VulkanDeviceTable::vkCreateGraphicsPipelines, "'thing'");
  fail(&VulkanDeviceTable::vkAllocateDescriptorSets, "bindings");
  EXPECT_TRUE(device->live_resources().empty());
  // New memory, which is allocated for what does not fit into a block.
  const auto real = std::exchange(context->vk.vkAllocateMemory, &Failing<PFN_vkAllocateMemory>::call);
  Failing<PFN_vkAllocateMemory>::result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
  test::expect_contains(test::error_of([&] {
                          static_cast<void>(device->create_texture(
                              {.name = "large", .format = Format::RGBA32F, .width = 2048, .height = 2048}));
                        }),
                        "texture 'large': the driver is out of memory");
  context->vk.vkAllocateMemory = real;
  EXPECT_EQ(drawn(3), expected);
}

// SwiftShader has textures of 2048 layers, and draws into 256 at once. Its limit for lamps with shadows was 42.
TEST_F(VulkanFailure, MoreLayersThanAPassCanDrawAreRefusedByNameAndOneOfThemIsDrawn)
{
  context->limits.maxFramebufferLayers = 256;
  const Texture array = device->create_texture(
      {.name = "many", .kind = TextureKind::Array, .format = Format::RGBA32F, .width = 2, .height = 2, .layers = 300});
  test::expect_contains(test::error_of([&] {
                          static_cast<void>(device->create_framebuffer({"all", {{&array, all_layers}}, {}}));
                        }),
                        "framebuffer 'all': 300 layers, but this device draws into at most 256 at once");
  const Framebuffer last = device->create_framebuffer({"last", {{&array, 299}}, {}});
  CommandList list;
  list.begin_pass("last", last, {.clear_color = glm::vec4(3)});
  list.end_pass();
  device->submit(list);
  EXPECT_EQ(read_as<glm::vec4>(*device, array, 299), std::vector<glm::vec4>(4, glm::vec4(3)));
}

/** By each function that may report it: at the start and the end of recording, at submission, while waiting, at reads.
 */
TEST_F(VulkanFailure, ALostDeviceIsAnErrorUntilAnotherIsMade)
{
  const auto lose = [&](auto member) {
    test::expect_contains(error_if(member, VK_ERROR_DEVICE_LOST), "lost");
    EXPECT_THROW(drawn(3), DeviceLost);
    make();
    EXPECT_EQ(drawn(3), std::vector<glm::vec4>(4, glm::vec4(3)));
  };
  lose(&VulkanDeviceTable::vkQueueSubmit2);
  lose(&VulkanDeviceTable::vkWaitSemaphores);
  lose(&VulkanDeviceTable::vkGetSemaphoreCounterValue);
  lose(&VulkanDeviceTable::vkBeginCommandBuffer);
  lose(&VulkanDeviceTable::vkEndCommandBuffer);
  lose(&VulkanDeviceTable::vkGetQueryPoolResults);
}

/** Descriptor pools that are made, that are used again, and that are destroyed. */
struct CountedPools {
  static inline PFN_vkCreateDescriptorPool real_create = nullptr;
  static inline PFN_vkResetDescriptorPool real_reset = nullptr;
  static inline PFN_vkDestroyDescriptorPool real_destroy = nullptr;
  static inline int made = 0;
  static inline int reset = 0;
  static inline int destroyed = 0;

  static VkResult VKAPI_PTR create_pool(VkDevice device, const VkDescriptorPoolCreateInfo *info,
                                        const VkAllocationCallbacks *allocator, VkDescriptorPool *pool)
  {
    made++;
    return real_create(device, info, allocator, pool);
  }
  static VkResult VKAPI_PTR reset_pool(VkDevice device, VkDescriptorPool pool, VkDescriptorPoolResetFlags flags)
  {
    reset++;
    return real_reset(device, pool, flags);
  }
  static void VKAPI_PTR destroy_pool(VkDevice device, VkDescriptorPool pool, const VkAllocationCallbacks *allocator)
  {
    destroyed++;
    real_destroy(device, pool, allocator);
  }
};

/** Also where a pool gives more sets than it is made for. */
TEST_F(VulkanFailure, SetsOfDescriptorsAreUsedAgainAndGivenBack)
{
  CountedPools::real_create = std::exchange(context->vk.vkCreateDescriptorPool, &CountedPools::create_pool);
  CountedPools::real_reset = std::exchange(context->vk.vkResetDescriptorPool, &CountedPools::reset_pool);
  CountedPools::real_destroy = std::exchange(context->vk.vkDestroyDescriptorPool, &CountedPools::destroy_pool);
  CountedPools::made = CountedPools::reset = CountedPools::destroyed = 0;
  const Texture picture = device->create_texture({.name = "p", .format = Format::RGBA32F, .width = 2, .height = 2});
  const Texture texel = device->create_texture({.name = "t", .format = Format::RGBA32F});
  const Framebuffer framebuffer = device->create_framebuffer({"p", {{&picture}}, {}});
  const Sampler sampler = device->create_sampler({.name = "nearest"});
  const Shader shader = test::make_shader(*device, "lookup", test::CLIP_SPACE_VERT, R"(
layout(binding = 16) uniform sampler2D texel;
layout(location = 0) out vec4 result;
void main()
{
  result = texelFetch(texel, ivec2(0), 0);
})");
  const Batch full = test::full_triangle(*device, 0.5F);
  CommandList list;
  list.begin_pass("p", framebuffer, {});
  list.set_shader(shader.id());
  list.set_state(State::WriteColor);
  constexpr int draw_count = 64;
  for (int i = 0; i < draw_count; i++) {
    list.bind_texture(16, texel.id(), sampler.id());
    test::append_draw(list, full);
  }
  list.end_pass();
  constexpr int list_count = 20;
  for (int i = 0; i < list_count; i++) {
    device->submit(list);
    device->finish();
  }
  EXPECT_LE(CountedPools::made, 2);
  // A pool has at most 128 sets.
  EXPECT_GE(CountedPools::made + CountedPools::reset, draw_count * list_count / 128);
  EXPECT_EQ(CountedPools::destroyed, 0);
  device->trim();
  EXPECT_EQ(CountedPools::destroyed, CountedPools::made);
  device->submit(list);
  device->finish();
  EXPECT_EQ(CountedPools::made, CountedPools::destroyed + 1);
}

/** Barriers, of which one changes layouts, but orders nothing. */
struct WeakBarrier {
  static inline PFN_vkCmdPipelineBarrier2 real = nullptr;
  static inline PFN_vkBeginCommandBuffer real_begin = nullptr;
  static inline int count = 0;
  /** Number of the barrier; -1: none. */
  static inline int weak = -1;
  static inline bool is_first = false;
  /** The weak one is the first of a submission. */
  static inline bool is_weak_first = false;

  static void begin(VulkanDeviceTable &vk, int weak_one)
  {
    real = std::exchange(vk.vkCmdPipelineBarrier2, &record);
    real_begin = std::exchange(vk.vkBeginCommandBuffer, &begin_commands);
    count = 0;
    weak = weak_one;
  }
  static VkResult VKAPI_PTR begin_commands(VkCommandBuffer commands, const VkCommandBufferBeginInfo *info)
  {
    is_first = true;
    return real_begin(commands, info);
  }
  static void VKAPI_PTR record(VkCommandBuffer commands, const VkDependencyInfo *info)
  {
    const bool was_first = std::exchange(is_first, false);
    if (count++ != weak) {
      real(commands, info);
      return;
    }
    is_weak_first = was_first;
    test::record_weak_barrier(real, commands, *info);
  }
};

/** A pass, mip levels, a pass that reads them and a buffer, an update of the buffer, a copy, and a read. */
glm::vec4 drawn_in_steps(Device &device)
{
  const Texture first =
      device.create_texture({.name = "first", .format = Format::RGBA32F, .width = 2, .height = 2, .mip_levels = 2});
  const Texture second = device.create_texture({.name = "second", .format = Format::RGBA32F, .width = 1, .height = 1});
  const Texture third = device.create_texture({.name = "third", .format = Format::RGBA32F, .width = 1, .height = 1});
  const Framebuffer onto_first = device.create_framebuffer({"first", {{&first}}, {}});
  const Framebuffer onto_second = device.create_framebuffer({"second", {{&second}}, {}});
  const Sampler sampler = device.create_sampler({.name = "nearest", .mip = MipFilter::Nearest});
  const Buffer block = device.create_buffer({.name = "block", .size_bytes = sizeof(glm::vec4)});
  const Shader shader = test::make_shader(device, "sum", test::CLIP_SPACE_VERT, R"(
layout(binding = 16) uniform sampler2D levels;
layout(binding = 1, std140) uniform block_of_sum { vec4 more; };
layout(location = 0) out vec4 result;
void main()
{
  result = texelFetch(levels, ivec2(0), 1) + more;
})");
  const Batch full = test::full_triangle(device, 0.5F);
  device.update(block, glm::vec4(1));
  CommandList list;
  list.begin_pass("first", onto_first, {.clear_color = glm::vec4(3)});
  list.end_pass();
  device.submit(list);
  device.generate_mipmaps(first);
  CommandList sum;
  sum.begin_pass("sum", onto_second, {.color_load = LoadAction::DontCare});
  sum.set_shader(shader.id());
  sum.set_state(State::WriteColor);
  sum.bind_texture(16, first.id(), sampler.id());
  sum.bind_uniform(1, {.buffer = block.id()});
  test::append_draw(sum, full);
  sum.end_pass();
  device.submit(sum);
  device.update(block, glm::vec4(2));
  device.submit(sum);
  device.copy_layers(second, third);
  return read_as<glm::vec4>(device, third).front();
}

/** A barrier between any two writes would be one for each part of a mesh that changes. */
TEST_F(VulkanFailure, OnlyWritesOfTheSameBytesHaveABarrierBetweenThem)
{
  const Texture picture = device->create_texture({.name = "picture", .format = Format::RGBA32F});
  const Framebuffer framebuffer = device->create_framebuffer({"picture", {{&picture}}, {}});
  constexpr std::size_t part_count = 8;
  const Buffer parts = device->create_buffer({.name = "parts", .size_bytes = part_count * sizeof(glm::vec4)});
  const Shader shader = test::make_shader(*device, "sum of parts", test::CLIP_SPACE_VERT, R"(
layout(binding = 1, std140) uniform block_of_parts { vec4 parts[8]; };
layout(location = 0) out vec4 result;
void main()
{
  result = vec4(0);
  for (int i = 0; i < 8; i++) {
    result += parts[i];
  }
})");
  const Batch full = test::full_triangle(*device, 0.5F);
  CommandList list;
  list.begin_pass("sum", framebuffer, {.color_load = LoadAction::DontCare});
  list.set_shader(shader.id());
  list.set_state(State::WriteColor);
  list.bind_uniform(1, {.buffer = parts.id()});
  test::append_draw(list, full);
  list.end_pass();
  device->update(parts, std::array<glm::vec4, part_count>{});
  device->submit(list);
  WeakBarrier::begin(context->vk, -1);
  const auto write = [&](std::size_t part, float value) {
    const glm::vec4 texel(value);
    device->update(parts, part * sizeof(texel), std::as_bytes(std::span(&texel, 1)));
  };
  // Each part once, in no order: one barrier, after the draw.
  for (std::size_t i = 0; i < part_count; i++) {
    write(i * 3 % part_count, 1);
  }
  EXPECT_EQ(WeakBarrier::count, 1);
  write(2, 5);
  EXPECT_EQ(WeakBarrier::count, 2);
  write(3, 5);
  EXPECT_EQ(WeakBarrier::count, 2);
  // The end of one part and the begin of the next.
  const std::array<glm::vec2, 2> across{glm::vec2(7), glm::vec2(7)};
  device->update(parts, 2 * sizeof(glm::vec4) + sizeof(glm::vec2), std::as_bytes(std::span(across)));
  EXPECT_EQ(WeakBarrier::count, 3);
  device->submit(list);
  EXPECT_EQ(read_as<glm::vec4>(*device, picture).front(), glm::vec4(18, 18, 18, 18));
}

/** Each barrier is needed, and the checks of synchronisation, with which the driver tests run, find that it lacks. */
TEST_F(VulkanFailure, WithoutAnyOneOfItsBarriersADrawIsAnError)
{
  WeakBarrier::begin(context->vk, -1);
  EXPECT_EQ(drawn_in_steps(*device), glm::vec4(5));
  const int count = WeakBarrier::count;
  int found = 0;
  // The last one is for the CPU, whose reads are not checked.
  for (int i = 0; i + 1 < count; i++) {
    make();
    device->finish();
    WeakBarrier::begin(context->vk, i);
    const std::string message = test::error_of([&] { drawn_in_steps(*device); });
    const bool is_found = message.find("SYNC-HAZARD") != std::string::npos;
    found += is_found ? 1 : 0;
    // The layers look at each submission by itself.
    EXPECT_TRUE(is_found || WeakBarrier::is_weak_first) << "barrier " << i << " of " << count << ": " << message;
  }
  EXPECT_GE(found, 6);
}

}  // namespace
}  // namespace gnomon::gpu
