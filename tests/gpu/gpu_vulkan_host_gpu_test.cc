// SPDX-License-Identifier: MIT
// A device on the VkDevice of a host, and draws into the host's images. The host uses the validation layers with checks
// of synchronisation and of threads, and their messages are failures. These need no GNOMON_TEST_BACKEND.
#include "gpu/gpu_host_vertices.hh"
#include "gpu/gpu_testing.hh"
#include "gpu/gpu_vulkan_host.hh"
#include "gpu_create_device.hh"
#include "gpu_device_fixture.hh"
#include "vulkan/vulkan_device.hh"

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <thread>

namespace gnomon::gpu {
namespace {

using test::error_of;
using test::expect_contains;
using test::VulkanTestHost;
using Texel = std::array<std::uint8_t, 4>;

class VulkanHostGpu : public testing::Test {
 protected:
  void SetUp() override
  {
    const auto device = test::testing_vulkan_device();
    if (!device && !HasFailure()) {
      GTEST_SKIP();
    }
    ASSERT_TRUE(device);
    host = std::make_unique<VulkanTestHost>();
  }
  [[nodiscard]] std::unique_ptr<Device> make_device() const
  {
    return make_device(host->handles());
  }
  [[nodiscard]] static std::unique_ptr<Device> make_device(const VulkanHost &handles)
  {
    return create_vulkan_device({.compile_spirv = shader_check::compile_spirv, .host = handles});
  }

  std::unique_ptr<VulkanTestHost> host;
};

/** A pass that writes x and y of each pixel of a rectangle: red and green are the pixel over 255. */
class Picture {
 public:
  explicit Picture(Device &device) : device_(device) {}

  [[nodiscard]] CommandList list(const Framebuffer &framebuffer, const PassActions &actions) const
  {
    CommandList commands;
    commands.begin_pass("picture", framebuffer, actions);
    commands.set_shader(shader_.id());
    commands.set_state(State::WriteColor);
    test::append_draw(commands, full_);
    commands.end_pass();
    return commands;
  }

 private:
  Device &device_;
  Batch full_ = test::full_triangle(device_, 0.5F);
  Shader shader_ = test::make_shader(device_, "pixels", test::CLIP_SPACE_VERT, R"(
layout(location = 0) out vec4 result;
void main()
{
  result = vec4(floor(gl_FragCoord.xy) / 255.0, 0.0, 1.0);
})");
};

constexpr glm::ivec2 image_size_px{6, 4};
/** The host's colour before draws. */
constexpr std::array<float, 4> before = {0.2F, 0.4F, 0.6F, 0.8F};
constexpr Texel before_bytes = {51, 102, 153, 204};

/** The value that Picture writes to the pixels of a row from the bottom. */
Texel drawn(int x, int y)
{
  return {std::uint8_t(x), std::uint8_t(y), 0, 255};
}

TEST_F(VulkanHostGpu, DrawsIntoARectangleInEitherOrderOfRowsAndKeepsTheRest)
{
  const auto device = make_device();
  const Picture picture(*device);
  const VulkanTestHost::Image image = host->make_image(VK_FORMAT_R8G8B8A8_UNORM, image_size_px.x, image_size_px.y);
  for (const RowOrder rows : {RowOrder::TopFirst, RowOrder::BottomFirst}) {
    const Framebuffer framebuffer =
        device->create_framebuffer("theirs", HostImage{image.image, VK_FORMAT_R8G8B8A8_UNORM, image_size_px, 1, rows});
    host->clear(image, before);
    device->begin_image(framebuffer, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    const Rectangle rectangle{{1, 0}, {3, 2}};
    device->submit(picture.list(framebuffer, {.color_load = LoadAction::Load, .scissor = rectangle}));
    device->end_image(framebuffer, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    const std::vector<Texel> texels = host->read(image);
    for (int row = 0; row < image_size_px.y; row++) {
      for (int x = 0; x < image_size_px.x; x++) {
        const int y = rows == RowOrder::TopFirst ? image_size_px.y - 1 - row : row;
        const bool is_inside = x >= 1 && x < 4 && y < 2;
        EXPECT_EQ(texels[std::size_t(row * image_size_px.x + x)], is_inside ? drawn(x, y) : before_bytes)
            << x << ' ' << y << (rows == RowOrder::TopFirst ? " from the top" : "");
      }
    }
  }
  host->destroy(image);
}

TEST_F(VulkanHostGpu, FormatsHaveTheirOrderOfChannelsAndTheirEncoding)
{
  const auto device = make_device();
  for (const bool is_srgb : {false, true}) {
    const VkFormat format = is_srgb ? VK_FORMAT_B8G8R8A8_SRGB : VK_FORMAT_B8G8R8A8_UNORM;
    const VulkanTestHost::Image image = host->make_image(format, image_size_px.x, image_size_px.y);
    const Framebuffer framebuffer = device->create_framebuffer("theirs", HostImage{image.image, format, image_size_px});
    device->begin_image(framebuffer, VK_IMAGE_LAYOUT_UNDEFINED);
    CommandList list;
    list.begin_pass("clear", framebuffer, {.clear_color = {1, 0.5F, 0, 1}, .is_srgb_encoded = is_srgb});
    list.end_pass();
    device->submit(list);
    device->end_image(framebuffer, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    for (const Texel &texel : host->read(image)) {
      // Half of the light is 188 of 255 in sRGB.
      EXPECT_NEAR(texel[1], is_srgb ? 188 : 128, 1);
      EXPECT_EQ(texel[0], 0);
      EXPECT_EQ(texel[2], 255);
    }
    host->destroy(image);
  }
}

TEST_F(VulkanHostGpu, EachSampleOfAnImageIsDrawn)
{
  const auto device = make_device();
  const Picture picture(*device);
  const VulkanTestHost::Image image =
      host->make_image(VK_FORMAT_R8G8B8A8_UNORM, image_size_px.x, image_size_px.y, VK_SAMPLE_COUNT_4_BIT);
  const VulkanTestHost::Image resolved = host->make_image(VK_FORMAT_R8G8B8A8_UNORM, image_size_px.x, image_size_px.y);
  const Framebuffer framebuffer = device->create_framebuffer(
      "theirs", HostImage{image.image, VK_FORMAT_R8G8B8A8_UNORM, image_size_px, 4, RowOrder::BottomFirst});
  device->begin_image(framebuffer, VK_IMAGE_LAYOUT_UNDEFINED);
  device->submit(picture.list(framebuffer, {}));
  device->end_image(framebuffer, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  host->clear(resolved, before);
  host->submit([&](VkCommandBuffer commands) {
    VkImageResolve region{};
    region.srcSubresource = region.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.extent = {std::uint32_t(image_size_px.x), std::uint32_t(image_size_px.y), 1};
    host->of_device<PFN_vkCmdResolveImage>("vkCmdResolveImage")(commands, image.image,
                                                                VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, resolved.image,
                                                                VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
    host->change_layout(commands, resolved, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  });
  const std::vector<Texel> texels = host->read(resolved);
  for (int y = 0; y < image_size_px.y; y++) {
    for (int x = 0; x < image_size_px.x; x++) {
      EXPECT_EQ(texels[std::size_t(y * image_size_px.x + x)], drawn(x, y));
    }
  }
  host->destroy(resolved);
  host->destroy(image);
}

/** A semaphore that nobody waits for, or that is not signalled, is a message of the layers in the next frame. */
TEST_F(VulkanHostGpu, WaitsForAndSignalsTheSemaphoresOfEachFrame)
{
  const auto device = make_device();
  const Picture picture(*device);
  const VulkanTestHost::Image image = host->make_image(VK_FORMAT_R8G8B8A8_UNORM, image_size_px.x, image_size_px.y);
  const Framebuffer framebuffer =
      device->create_framebuffer("theirs", HostImage{image.image, VK_FORMAT_R8G8B8A8_UNORM, image_size_px});
  const VkSemaphore acquired = host->make_semaphore(false);
  const VkSemaphore binary = host->make_semaphore(false);
  const VkSemaphore timeline = host->make_semaphore(true);
  for (std::uint64_t frame = 1; frame <= 4; frame++) {
    const HostSemaphore done = frame % 2 == 0 ? HostSemaphore{timeline, frame} : HostSemaphore{binary};
    host->clear(image, before, {acquired});
    Packet packet;
    {
      // A thread that prepares frames does the same.
      const Recording recording(*device, packet);
      device->begin_image(framebuffer, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, {acquired});
      device->submit(picture.list(framebuffer, {.color_load = LoadAction::Load, .scissor = {{0, 0}, {1, 1}}}));
      device->submit(picture.list(framebuffer, {.color_load = LoadAction::Load, .scissor = {{5, 3}, {1, 1}}}));
      device->end_image(framebuffer, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, done);
    }
    device->submit(packet);
    const std::vector<Texel> texels = host->read(image, done);
    EXPECT_EQ(texels[std::size_t(3 * image_size_px.x)], drawn(0, 0));
    EXPECT_EQ(texels[5], drawn(5, 3));
    EXPECT_EQ(texels[0], before_bytes);
  }
  std::uint64_t value = 0;
  host->of_device<PFN_vkGetSemaphoreCounterValue>("vkGetSemaphoreCounterValue")(host->device, timeline, &value);
  EXPECT_EQ(value, 4U);
  device->finish();
  host->destroy(acquired);
  host->destroy(binary);
  host->destroy(timeline);
  host->destroy(image);
}

/** The layers report a queue that two threads use at once. */
TEST_F(VulkanHostGpu, AnotherThreadMayUseTheQueueUnderItsLock)
{
  std::mutex queue_mutex;
  std::atomic<int> locks = 0;
  VulkanHost handles = host->handles();
  handles.lock_queue = [&] {
    queue_mutex.lock();
    locks++;
  };
  handles.unlock_queue = [&] { queue_mutex.unlock(); };
  const auto device = make_device(handles);
  const Picture picture(*device);
  const VulkanTestHost::Image image = host->make_image(VK_FORMAT_R8G8B8A8_UNORM, image_size_px.x, image_size_px.y);
  const VulkanTestHost::Image other = host->make_image(VK_FORMAT_R8G8B8A8_UNORM, image_size_px.x, image_size_px.y);
  const Framebuffer framebuffer =
      device->create_framebuffer("theirs", HostImage{image.image, VK_FORMAT_R8G8B8A8_UNORM, image_size_px});
  std::atomic<bool> is_done = false;
  std::atomic<int> cleared = 0;
  std::thread thread([&] {
    while (!is_done) {
      const std::scoped_lock lock(queue_mutex);
      host->clear(other, before);
      cleared++;
    }
  });
  constexpr int frame_count = 50;
  for (int frame = 0; frame < frame_count || cleared < frame_count; frame++) {
    device->begin_image(framebuffer, VK_IMAGE_LAYOUT_UNDEFINED);
    device->submit(picture.list(framebuffer, {}));
    device->end_image(framebuffer, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    device->finish();
  }
  is_done = true;
  thread.join();
  EXPECT_GE(locks, frame_count);
  EXPECT_EQ(host->read(image)[std::size_t(3 * image_size_px.x + 2)], drawn(2, 0));
  host->destroy(other);
  host->destroy(image);
}

TEST_F(VulkanHostGpu, DevicesStandBesideEachOtherAndTheHostsRemainsAfterThem)
{
  const VulkanTestHost::Image image = host->make_image(VK_FORMAT_R8G8B8A8_UNORM, image_size_px.x, image_size_px.y);
  {
    const auto first = make_device();
    const auto second = make_device();
    for (Device *device : {first.get(), second.get(), first.get()}) {
      const Framebuffer framebuffer =
          device->create_framebuffer("theirs", HostImage{image.image, VK_FORMAT_R8G8B8A8_UNORM, image_size_px});
      device->begin_image(framebuffer, VK_IMAGE_LAYOUT_UNDEFINED);
      device->submit(Picture(*device).list(framebuffer, {}));
      device->end_image(framebuffer, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
      EXPECT_EQ(host->read(image)[0], drawn(0, 3));
    }
    expect_contains(first->description(), "Vulkan 1.");
  }
  host->clear(image, before);
  host->destroy(image);
}

VkResult VKAPI_PTR lose(VkQueue /*queue*/, std::uint32_t /*count*/, const VkSubmitInfo2 * /*infos*/, VkFence /*fence*/)
{
  return VK_ERROR_DEVICE_LOST;
}

TEST_F(VulkanHostGpu, ALostDeviceIsAnErrorUntilTheHostMakesAnother)
{
  auto made = std::make_unique<VulkanContext>(host->handles());
  made->vk.vkQueueSubmit2 = &lose;
  auto device =
      std::make_unique<VulkanDevice>(std::move(made), VulkanDeviceDesc{.compile_spirv = shader_check::compile_spirv});
  const VulkanTestHost::Image image = host->make_image(VK_FORMAT_R8G8B8A8_UNORM, image_size_px.x, image_size_px.y);
  const HostImage theirs{image.image, VK_FORMAT_R8G8B8A8_UNORM, image_size_px};
  {
    const Framebuffer framebuffer = device->create_framebuffer("theirs", theirs);
    device->begin_image(framebuffer, VK_IMAGE_LAYOUT_UNDEFINED);
    EXPECT_THROW(device->end_image(framebuffer, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL), DeviceLost);
    expect_contains(error_of([&] { device->finish(); }), "lost; create a new device");
  }
  device.reset();
  const auto another = make_device();
  {
    const Framebuffer framebuffer = another->create_framebuffer("theirs", theirs);
    another->begin_image(framebuffer, VK_IMAGE_LAYOUT_UNDEFINED);
    another->submit(Picture(*another).list(framebuffer, {}));
    another->end_image(framebuffer, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  }
  EXPECT_EQ(host->read(image)[0], drawn(0, 3));
  host->destroy(image);
}

TEST_F(VulkanHostGpu, ImagesAreRefusedByNameAndTheDeviceRemainsUsable)
{
  const auto device = make_device();
  const Picture picture(*device);
  const VulkanTestHost::Image image = host->make_image(VK_FORMAT_R8G8B8A8_SRGB, image_size_px.x, image_size_px.y);
  const HostImage good{image.image, VK_FORMAT_R8G8B8A8_SRGB, image_size_px, 1, RowOrder::BottomFirst};
  const auto refused = [&](auto &&change, std::string_view part) {
    HostImage changed = good;
    change(changed);
    const std::string message = error_of([&] { static_cast<void>(device->create_framebuffer("theirs", changed)); });
    expect_contains(message, "framebuffer 'theirs'");
    expect_contains(message, part);
  };
  refused([](HostImage &i) { i.image = nullptr; }, "no image");
  refused([](HostImage &i) { i.size_px = {0, 4}; }, "0x4");
  refused([](HostImage &i) { i.format = VK_FORMAT_D32_SFLOAT; }, "VkFormat 126");
  refused(
      [](HostImage &i) {
        i.samples = 4;
        i.rows = RowOrder::TopFirst;
      },
      "4 samples");
  const Framebuffer framebuffer = device->create_framebuffer("theirs", good);
  const auto fails = [&](auto &&action, std::string_view part) {
    const std::string message = error_of(action);
    expect_contains(message, "framebuffer 'theirs'");
    expect_contains(message, part);
  };
  const PassActions encoded{.is_srgb_encoded = true};
  fails([&] { device->submit(picture.list(framebuffer, encoded)); }, "outside of begin_image");
  fails([&] { device->end_image(framebuffer, VK_IMAGE_LAYOUT_GENERAL); }, "do not alternate");
  device->begin_image(framebuffer, VK_IMAGE_LAYOUT_UNDEFINED);
  fails([&] { device->begin_image(framebuffer, VK_IMAGE_LAYOUT_UNDEFINED); }, "do not alternate");
  fails([&] { device->end_image(framebuffer, VK_IMAGE_LAYOUT_UNDEFINED); }, "VkImageLayout 0");
  fails([&] { device->submit(picture.list(framebuffer, {})); }, "encodes the colours");
  device->submit(picture.list(framebuffer, encoded));
  device->end_image(framebuffer, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
  EXPECT_EQ(host->read(image).size(), 24U);
  host->destroy(image);
}

TEST_F(VulkanHostGpu, WhatTheDeviceLacksIsListedByName)
{
  const auto refusal = [](std::string_view missing) {
    const VulkanTestHost host(missing);
    return error_of([&] {
      static_cast<void>(create_vulkan_device({.compile_spirv = shader_check::compile_spirv, .host = host.handles()}));
    });
  };
  EXPECT_EQ(refusal({}), "");
  for (const char *name : {"multiDrawIndirect", "hostQueryReset", "provokingVertexLast"}) {
    EXPECT_TRUE(refusal(name).ends_with(std::string("is made without ") + name)) << refusal(name);
  }
  // Without the extension, its feature is missing, too.
  expect_contains(refusal(VK_EXT_PROVOKING_VERTEX_EXTENSION_NAME),
                  "is made without VK_EXT_provoking_vertex, provokingVertexLast");
  expect_contains(
      error_of([] {
        static_cast<void>(create_vulkan_device({.compile_spirv = shader_check::compile_spirv, .host = VulkanHost{}}));
      }),
      "loader");
}

TEST_F(VulkanHostGpu, TheBackendIsTheHosts)
{
  const auto create = [&](Backend backend) {
    return create_device({.backend = backend, .host = host->handles(), .compile_spirv = shader_check::compile_spirv});
  };
  expect_contains(create(Backend::Auto)->description(), "Vulkan");
  expect_contains(create(Backend::Vulkan)->description(), "Vulkan");
  expect_contains(error_of([&] { create(Backend::OpenGl); }), "backend 'gl': the host's is 'vulkan'");
}

/** An error within a pass ends it, so that the next list draws. */
TEST_F(VulkanHostGpu, AnImageHasNoDepthAndIsDrawnIntoAfterTheError)
{
  const auto device = make_device();
  const Picture picture(*device);
  const VulkanTestHost::Image image = host->make_image(VK_FORMAT_R8G8B8A8_UNORM, image_size_px.x, image_size_px.y);
  const Framebuffer framebuffer =
      device->create_framebuffer("theirs", HostImage{image.image, VK_FORMAT_R8G8B8A8_UNORM, image_size_px});
  for (const State state : {State::DepthNearerEqual, State::DepthLessEqual, State::WriteDepth}) {
    device->begin_image(framebuffer, VK_IMAGE_LAYOUT_UNDEFINED);
    CommandList list;
    list.begin_pass("deep", framebuffer, {.clear_color = {1, 1, 1, 1}});
    list.set_state(State::WriteColor | state);
    list.end_pass();
    expect_contains(error_of([&] { device->submit(list); }), "framebuffer 'theirs' of the host's image has no depth");
    device->submit(picture.list(framebuffer, {.color_load = LoadAction::Load}));
    device->end_image(framebuffer, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL);
    const std::vector<Texel> texels = host->read(image);
    for (int row = 0; row < image_size_px.y; row++) {
      for (int x = 0; x < image_size_px.x; x++) {
        EXPECT_EQ(texels[std::size_t(row * image_size_px.x + x)], drawn(x, image_size_px.y - 1 - row))
            << x << ' ' << row;
      }
    }
  }
  host->destroy(image);
}

/** The values that draws of a list write to a picture of floats. */
class FloatPicture {
 public:
  explicit FloatPicture(Device &device) : device_(device) {}

  [[nodiscard]] std::vector<glm::vec4> drawn(const Shader &shader, const std::function<void(CommandList &)> &draw) const
  {
    CommandList list;
    list.begin_pass("picture", framebuffer_, {.clear_color = glm::vec4(-1)});
    list.set_shader(shader.id());
    list.set_state(State::WriteColor);
    draw(list);
    list.end_pass();
    device_.submit(list);
    return read_as<glm::vec4>(device_, picture_);
  }

 private:
  Device &device_;
  Texture picture_ = device_.create_texture({.name = "picture", .format = Format::RGBA32F, .width = 10, .height = 2});
  Framebuffer framebuffer_ = device_.create_framebuffer({"picture", {{&picture_}}, {}});
};

TEST_F(VulkanHostGpu, BuffersOfTheHostDrawWhatABatchDraws)
{
  if (!host->reads_vertices(VK_FORMAT_R16G16B16_SFLOAT)) {
    GTEST_SKIP() << "the device reads no three half floats from buffers, as the normals of this test";
  }
  const test::Vertices vertices;
  const test::InterleavedVertices interleaved(vertices);
  const VulkanTestHost::Buffer vertex_buffer = host->make_buffer(interleaved.bytes);
  const VulkanTestHost::Buffer index_buffer = host->make_buffer(interleaved.indices);
  {
    const auto device = make_device();
    const FloatPicture picture(*device);
    const Shader shader = test::make_shader(*device, "streams", test::streams_vert, test::streams_frag);
    const HostBatch of_host = interleaved.batch(vertex_buffer.handle(), index_buffer.handle());
    const Batch batch = device->create_batch("theirs", of_host);
    HostBatch positions = of_host;
    for (HostStream *stream :
         {&positions.normals, &positions.uvs, &positions.second_uvs, &positions.tangents, &positions.colors}) {
      *stream = {};
    }
    const Batch positions_only = device->create_batch("theirs, positions", positions);
    const auto draw_host = [](const Batch &of) {
      return [&](CommandList &list) {
        list.bind_host_batch(of.id());
        test::append_draw(list, of);
      };
    };
    // Before there is a batch in the shared buffers.
    const std::vector<glm::vec4> drawn = picture.drawn(shader, draw_host(batch));
    const Batch copy = vertices.make_batch(*device);
    const auto draw_copy = [&](CommandList &list) {
      list.bind_host_batch(0);
      test::append_draw(list, copy);
    };
    EXPECT_EQ(drawn, picture.drawn(shader, draw_copy));
    EXPECT_EQ(drawn[1], glm::vec4(2.0F, -3.0F, 0.5F, 0.125F));
    // Both kinds in one list, in both orders.
    const std::vector<glm::vec4> absent = picture.drawn(shader, [&](CommandList &list) {
      draw_copy(list);
      draw_host(positions_only)(list);
    });
    EXPECT_EQ(absent[0], glm::vec4(0));
    EXPECT_EQ(absent[1], glm::vec4(0));
    EXPECT_EQ(absent[2], glm::vec4(0));
    EXPECT_EQ(absent[3], glm::vec4(1));
    EXPECT_EQ(absent[4], glm::vec4(0.25F));
    EXPECT_EQ(drawn, picture.drawn(shader, [&](CommandList &list) {
      draw_host(positions_only)(list);
      draw_copy(list);
    }));
    // The host writes its buffer between lists.
    const glm::vec2 written(7, 8);
    for (std::size_t i = 0; i < 3; i++) {
      const std::size_t offset = of_host.second_uvs.offset_bytes + i * of_host.second_uvs.stride_bytes;
      std::memcpy(static_cast<std::byte *>(vertex_buffer.mapped) + offset, &written, sizeof(written));
    }
    EXPECT_EQ(picture.drawn(shader, draw_host(batch))[1], glm::vec4(2.0F, -3.0F, 7.0F, 8.0F));

    HostBatch wrong = of_host;
    wrong.normals.offset_bytes += 1;
    expect_contains(error_of([&] { static_cast<void>(device->create_batch("wrong", wrong)); }),
                    "batch 'wrong': the normals of the host begin at byte 21");
  }
  host->destroy(vertex_buffer);
  host->destroy(index_buffer);
}

TEST_F(VulkanHostGpu, TexturesOfTheHostAreLookedUp)
{
  const VulkanTestHost::Image image = host->make_image(VK_FORMAT_B8G8R8A8_UNORM, 2, 2);
  const auto fill = [&](const std::array<float, 4> &color, VkImageLayout layout) {
    host->clear(image, color);
    host->submit([&](VkCommandBuffer commands) {
      host->change_layout(commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, layout);
    });
  };
  {
    const auto device = make_device();
    const FloatPicture picture(*device);
    const Batch full = test::full_triangle(*device, 0.5F);
    const Sampler sampler = device->create_sampler({.name = "linear", .filter = Filter::Linear});
    const Shader shader = test::make_shader(*device, "look up", test::CLIP_SPACE_VERT, R"(
layout(binding = RADIANCE_SLOT) uniform sampler2D theirs;
layout(location = 0) out vec4 result;
void main()
{
  result = texture(theirs, vec2(0.5));
})");
    const HostTexture theirs{.name = (HostHandle)image.image,
                             .size_px = {2, 2},
                             .format = VK_FORMAT_B8G8R8A8_UNORM,
                             .layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    const Texture texture = device->create_texture(texture_desc("theirs", theirs));
    HostTexture general = theirs;
    general.layout = VK_IMAGE_LAYOUT_GENERAL;
    const Texture texture_general = device->create_texture(texture_desc("theirs, general", general));
    const auto looked_up = [&](const Texture &of) {
      return picture.drawn(shader, [&](CommandList &list) {
        list.bind_texture(shader.interface().find(BindingKind::Texture, "theirs")->slot, of.id(), sampler.id());
        test::append_draw(list, full);
      })[0];
    };
    fill({0.2F, 0.4F, 0.6F, 0.8F}, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    EXPECT_EQ(glm::round(255.0F * looked_up(texture)), glm::vec4(51, 102, 153, 204));
    // Values that the host writes between lists, in either layout.
    fill({1, 0, 0, 1}, VK_IMAGE_LAYOUT_GENERAL);
    EXPECT_EQ(looked_up(texture_general), glm::vec4(1, 0, 0, 1));

    const auto refused = [&](int format, int layout) {
      HostTexture wrong = theirs;
      wrong.format = format;
      wrong.layout = layout;
      return error_of([&] { static_cast<void>(device->create_texture(texture_desc("wrong", wrong))); });
    };
    expect_contains(refused(VK_FORMAT_R8G8B8A8_UINT, theirs.layout), "texture 'wrong': the device cannot look up");
    expect_contains(refused(theirs.format, VK_IMAGE_LAYOUT_UNDEFINED), "texture 'wrong': no image");
  }
  host->destroy(image);
}

/** The names that a device has given, by the type of object, and those of groups of commands. */
struct VulkanNames {
  static inline PFN_vkGetInstanceProcAddr loader = nullptr;
  static inline std::map<VkObjectType, std::vector<std::string>> objects;
  static inline std::vector<std::string> groups;
  static inline int open_groups = 0;

  static VkResult VKAPI_PTR name_object(VkDevice /*device*/, const VkDebugUtilsObjectNameInfoEXT *info)
  {
    objects[info->objectType].emplace_back(info->pObjectName);
    return VK_SUCCESS;
  }
  static void VKAPI_PTR begin(VkCommandBuffer /*commands*/, const VkDebugUtilsLabelEXT *label)
  {
    groups.emplace_back(label->pLabelName);
    open_groups++;
  }
  static void VKAPI_PTR end(VkCommandBuffer /*commands*/)
  {
    open_groups--;
  }
  static PFN_vkVoidFunction VKAPI_PTR load(VkInstance instance, const char *name)
  {
    const std::string_view wanted(name);
    return wanted == "vkSetDebugUtilsObjectNameEXT"   ? reinterpret_cast<PFN_vkVoidFunction>(&name_object)
           : wanted == "vkCmdBeginDebugUtilsLabelEXT" ? reinterpret_cast<PFN_vkVoidFunction>(&begin)
           : wanted == "vkCmdEndDebugUtilsLabelEXT"   ? reinterpret_cast<PFN_vkVoidFunction>(&end)
                                                      : loader(instance, name);
  }
};

TEST_F(VulkanHostGpu, EveryResourceAndEveryPassHasANameForDebuggers)
{
  VulkanNames::loader = host->loader;
  VulkanHost handles = host->handles();
  handles.loader = &VulkanNames::load;
  const std::unique_ptr<Device> device = make_device(handles);
  VulkanNames::objects.clear();
  const Texture texture = device->create_texture({.name = "picture", .format = Format::RGBA8, .width = 6, .height = 4});
  const Framebuffer framebuffer = device->create_framebuffer({.name = "fb", .colors = {{&texture}}, .depth = {}});
  const Sampler sampler = device->create_sampler({.name = "nearest"});
  const Buffer block = device->create_buffer({"block", BufferKind::Uniform, 64});
  const TimerQuery timer = device->create_timer_query("timer");
  const Picture picture(*device);
  device->time_begin(timer);
  device->submit(picture.list(framebuffer, {}));
  device->time_end(timer);
  EXPECT_EQ(VulkanNames::groups, std::vector<std::string>{"picture"});
  EXPECT_EQ(VulkanNames::open_groups, 0);
  for (const auto &[type, name] :
       std::vector<std::pair<VkObjectType, std::string>>{{VK_OBJECT_TYPE_IMAGE, "picture"},
                                                         {VK_OBJECT_TYPE_IMAGE_VIEW, "framebuffer 'fb'"},
                                                         {VK_OBJECT_TYPE_SAMPLER, "sampler 'nearest'"},
                                                         {VK_OBJECT_TYPE_BUFFER, "block"},
                                                         {VK_OBJECT_TYPE_BUFFER, "positions"},
                                                         {VK_OBJECT_TYPE_BUFFER, "indices"},
                                                         {VK_OBJECT_TYPE_SHADER_MODULE, "pixels"},
                                                         {VK_OBJECT_TYPE_DESCRIPTOR_SET_LAYOUT, "pixels"},
                                                         {VK_OBJECT_TYPE_PIPELINE_LAYOUT, "pixels"},
                                                         {VK_OBJECT_TYPE_PIPELINE, "pixels"},
                                                         {VK_OBJECT_TYPE_QUERY_POOL, "timer"}}) {
    const std::vector<std::string> &names = VulkanNames::objects[type];
    EXPECT_TRUE(std::ranges::find(names, name) != names.end()) << "type " << type << ": " << name;
  }
}

}  // namespace
}  // namespace gnomon::gpu
