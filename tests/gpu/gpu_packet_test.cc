// SPDX-License-Identifier: MIT
#include "gpu/gpu_testing.hh"

#include <algorithm>
#include <future>
#include <thread>

namespace gnomon::gpu {
namespace {

using test::error_of;
using test::expect_contains;

/** A null device that notes its operations, and lets one of them fail. */
class PacketTest : public testing::Test {
 protected:
  /** Created resources that are not destroyed. */
  int existing() const
  {
    const auto is_destroy = [](const std::string &operation) { return operation.starts_with("destroy"); };
    const auto is_create = [](const std::string &operation) {
      return operation.starts_with("create") && operation != "create batch";
    };
    return int(std::ranges::count_if(operations, is_create) - std::ranges::count_if(operations, is_destroy));
  }

  std::vector<std::string> operations;
  /** Index in `operations`; -1: none. */
  int failing = -1;
  std::unique_ptr<Device> device = create_null_device({}, {}, [this](std::string_view operation) {
    if (int(operations.size()) == failing) {
      failing = -1;
      throw Error("{} fails", operation);
    }
    operations.emplace_back(operation);
  });
};

/** The resources of a frame, and the commands that draw it. */
struct Frame {
  Texture texture;
  Framebuffer framebuffer;
  Buffer buffer;
  Batch batch;

  void draw(Device &device)
  {
    if (!texture) {
      texture = device.create_texture({.name = "picture", .width = 2, .height = 2});
    }
    if (!framebuffer) {
      framebuffer = device.create_framebuffer({.name = "picture_fb", .colors = {{&texture}}, .depth = {}});
    }
    if (!buffer) {
      buffer = device.create_buffer({.name = "block", .size_bytes = 16});
    }
    if (!batch) {
      batch = test::full_triangle(device, 0.5F);
    }
    device.update(buffer, glm::vec4(1.0F));
    CommandList own;
    CommandList &list = device.is_recording() ? device.add_list() : own;
    list.update(buffer, 0, std::vector<std::byte>(4));
    list.begin_pass("pass", framebuffer, {});
    list.end_pass();
    device.submit(list);
  }
};

TEST_F(PacketTest, CallsReachTheDeviceWhenThePacketIsSubmitted)
{
  Frame frame;
  Packet packet;
  {
    const Recording recording(*device, packet);
    frame.draw(*device);
    EXPECT_TRUE(frame.texture);
    EXPECT_EQ(device->live_resources().size(), 4U);
  }
  EXPECT_EQ(operations, std::vector<std::string>());
  EXPECT_EQ(device->counters().passes, 0U);
  EXPECT_EQ(packet.serialize(*device),
            "create texture 'picture'\ncreate framebuffer 'picture_fb'\ncreate buffer 'block'\ncreate batch 'full'\n"
            "update block 16 bytes at 0\n"
            "update block 4 bytes at 0\nbegin pass -> picture_fb color clear/store depth clear/store\nend\n");
  device->submit(packet);
  const std::vector<std::string> expected = {
      "create texture", "create framebuffer", "create buffer", "create batch", "update", "submit"};
  EXPECT_EQ(operations, expected);
  EXPECT_EQ(device->counters().passes, 1U);
  EXPECT_EQ(device->counters().textures_made, 1U);
  EXPECT_EQ(device->counters().upload_bytes, 3 * 12 + 3 * 4 + 16 + 4U);
}

TEST_F(PacketTest, DescriptionsAreCheckedWhenTheyAreRecorded)
{
  Packet packet;
  {
    const Recording recording(*device, packet);
    const std::string message = error_of([&] { static_cast<void>(device->create_texture({.name = "t", .width = 0})); });
    expect_contains(message, "texture 't'");
#ifndef NDEBUG
    CommandList list;
    list.end_pass();
    expect_contains(error_of([&] { device->submit(list); }), "no pass to end");
#endif
  }
  device->submit(packet);
  EXPECT_EQ(operations, std::vector<std::string>());
}

TEST_F(PacketTest, ResourcesAreDestroyedAfterTheListsThatNameThem)
{
  Frame frame;
  std::array<Packet, 2> packets;
  {
    const Recording recording(*device, packets[0]);
    frame.draw(*device);
  }
  {
    const Recording recording(*device, packets[1]);
    frame.draw(*device);
    frame = {};
  }
  device->submit(packets[0]);
  EXPECT_EQ(existing(), 3);
  device->submit(packets[1]);
  EXPECT_EQ(existing(), 0);
  EXPECT_TRUE(operations.back().starts_with("destroy"));
}

TEST_F(PacketTest, ResourcesReleasedWhileAPacketIsPendingAreFreedAfterIt)
{
  auto frame = std::make_unique<Frame>();
  Packet packet;
  {
    const Recording recording(*device, packet);
    frame->draw(*device);
  }
  frame.reset();
  device->submit(packet);
  EXPECT_EQ(existing(), 3);
  const Sampler next = device->create_sampler({.name = "next"});
  EXPECT_EQ(existing(), 1);
  EXPECT_EQ(device->live_resources().size(), 1U);
}

/** For each operation of the first frame that fails. */
TEST_F(PacketTest, AFailedPacketLeavesNothingAndIsMadeAgain)
{
  for (int failed = 0; failed < 6; failed++) {
    SCOPED_TRACE(failed);
    operations.clear();
    Frame frame;
    Packet packet;
    const std::uint64_t losses = device->loss_count();
    failing = failed;
    expect_contains(error_of([&] { device->run(packet, [&] { frame.draw(*device); }); }), "fails");
    EXPECT_EQ(device->loss_count(), losses + 1);
    EXPECT_EQ(existing(), 0);
    EXPECT_EQ(device->live_resources(), std::vector<std::string>());
    EXPECT_FALSE(frame.texture || frame.framebuffer || frame.buffer || frame.batch);
    device->run(packet, [&] { frame.draw(*device); });
    EXPECT_EQ(device->loss_count(), losses + 1);
    EXPECT_EQ(existing(), 3);
    EXPECT_TRUE(frame.texture && frame.framebuffer && frame.buffer && frame.batch);
  }
}

TEST_F(PacketTest, WhatAFailedPacketDestroysIsFreed)
{
  Frame frame;
  frame.draw(*device);
  Packet packet;
  failing = int(operations.size());
  EXPECT_THROW(device->run(packet,
                           [&] {
                             frame.draw(*device);
                             frame = {};
                           }),
               Error);
  EXPECT_EQ(existing(), 0);
}

TEST_F(PacketTest, APacketThatBuildsOnALostOneIsLostAndTheNextIsNot)
{
  Frame frame;
  std::array<Packet, 3> packets;
  for (std::size_t i = 0; i < 2; i++) {
    const Recording recording(*device, packets[i]);
    frame.draw(*device);
  }
  failing = 0;
  expect_contains(error_of([&] { device->submit(packets[0]); }), "fails");
  // Recorded before the device's thread comes to the second.
  {
    const Recording recording(*device, packets[2]);
    EXPECT_FALSE(frame.texture);
    EXPECT_EQ(device->loss_count(), 1U);
    frame.draw(*device);
  }
  expect_contains(error_of([&] { device->submit(packets[1]); }), "earlier one was lost");
  EXPECT_EQ(existing(), 0);
  device->submit(packets[2]);
  EXPECT_EQ(existing(), 3);
  device->run(packets[0], [&] { frame.draw(*device); });
  EXPECT_EQ(device->loss_count(), 1U);
  EXPECT_EQ(existing(), 3);
}

TEST_F(PacketTest, AnUnsubmittedPacketThatIsRecordedAgainIsLost)
{
  Frame frame;
  frame.draw(*device);
  Packet packet;
  {
    const Recording recording(*device, packet);
    frame.framebuffer = {};
    frame.texture = {};
    frame.batch = {};
    frame.draw(*device);
  }
  EXPECT_TRUE(packet.is_pending());
  device->run(packet, [&] {
    EXPECT_EQ(device->loss_count(), 1U);
    EXPECT_FALSE(frame.texture || frame.framebuffer || frame.batch);
    EXPECT_TRUE(frame.buffer);
    frame.draw(*device);
  });
  EXPECT_EQ(existing(), 3);
}

TEST_F(PacketTest, WhatIsRecordedBeforeAnErrorIsSubmitted)
{
  Frame frame;
  Packet packet;
  EXPECT_THROW(device->run(packet,
                           [&] {
                             frame.draw(*device);
                             throw Error("no");
                           }),
               Error);
  EXPECT_EQ(existing(), 3);
  EXPECT_EQ(device->loss_count(), 0U);
  EXPECT_TRUE(frame.texture);
}

/** More than 4 MiB are not kept until the submission. */
TEST_F(PacketTest, LargeUploadsOfARunAreExecutedWhileItRecords)
{
  const std::vector<std::byte> texels(std::size_t(1024) * 1024 * 4);
  for (const int failed : {-1, 0, 1, 2, 3, 4}) {
    SCOPED_TRACE(failed);
    operations.clear();
    failing = failed;
    Packet packet;
    std::array<Texture, 3> textures;
    const auto draw = [&] {
      for (Texture &texture : textures) {
        if (!texture) {
          texture = device->create_texture({.name = "t", .width = 1024, .height = 1024});
          device->upload(texture, 0, texels);
        }
      }
    };
    const std::string message = error_of([&] {
      device->run(packet, [&] {
        draw();
        EXPECT_GE(operations.size(), 4U);
      });
    });
    EXPECT_EQ(message.empty(), failed < 0) << message;
    EXPECT_EQ(existing(), failed < 0 ? 3 : 0);
    device->run(packet, draw);
    EXPECT_EQ(existing(), 3);
    EXPECT_EQ(device->live_resources().size(), 3U);
  }
}

TEST_F(PacketTest, AFailedSubmitOutsideOfAPacketCountsAsALoss)
{
  Frame frame;
  failing = 5;
  EXPECT_THROW(frame.draw(*device), Error);
  EXPECT_EQ(device->loss_count(), 1U);
  EXPECT_TRUE(frame.texture);
}

TEST_F(PacketTest, FeedbackIsThatOfThePacketsLastSubmission)
{
  const Texture texture = device->create_texture({.name = "t", .format = Format::R32F, .width = 2, .height = 3});
  std::array<Packet, 2> packets;
  for (std::uint64_t frame = 0; frame < 6; frame++) {
    Packet &packet = packets[frame % 2];
    device->run(packet, [&] {
      if (frame >= 2) {
        ASSERT_EQ(packet.feedback().texels.size(), 1U);
        EXPECT_EQ(packet.feedback().texels[0].tag, frame - 2);
      }
      device->read_back(texture, 0, frame);
    });
    EXPECT_EQ(packet.feedback().texels[0].texture, texture.id());
    EXPECT_EQ(packet.feedback().texels[0].bytes, std::vector<std::byte>(2 * 3 * 4));
  }
}

TEST_F(PacketTest, OfALostPacketThereIsNoFeedback)
{
  const Texture texture = device->create_texture({.name = "t", .format = Format::R32F});
  Packet packet;
  const auto read = [&] { device->read_back(texture, 0, 0); };
  device->run(packet, read);
  EXPECT_EQ(packet.feedback().texels.size(), 1U);
  failing = 1;
  operations.clear();
  EXPECT_THROW(device->run(packet,
                           [&] {
                             read();
                             read();
                           }),
               Error);
  EXPECT_EQ(packet.feedback().texels.size(), 0U);
}

TEST(Packet, OutlivesItsDevice)
{
  Packet packet;
  Texture texture;
  {
    const auto device = create_null_device();
    const Recording recording(*device, packet);
    texture = device->create_texture({.name = "t"});
  }
  EXPECT_FALSE(texture);
}

TEST(DeviceInternalErrorTest, CallsOnAnotherThreadAreErrorsUnlessTheyAreRecorded)
{
  const auto device = create_null_device();
  const auto on_another_thread = [](auto &&call) { std::async(std::launch::async, call).get(); };
  const auto create = [&] { static_cast<void>(device->create_sampler({.name = "s"})); };
  const Texture texture = device->create_texture({.name = "t"});
  Packet packet;
  on_another_thread([&] {
    const Recording recording(*device, packet);
    create();
  });
  const char *message = "another thread than the device's";
  test::expect_internal_error([&] { on_another_thread([&] { device->submit(packet); }); }, message);
  device->submit(packet);
  test::expect_internal_error([&] { on_another_thread(create); }, message);
  test::expect_internal_error([&] { on_another_thread([&] { device->submit(CommandList()); }); }, message);
  test::expect_internal_error([&] { on_another_thread([&] { static_cast<void>(device->read(texture)); }); }, message);
}

TEST(PacketMemoryTest, SpansStayWhileMoreIsCopied)
{
  PacketMemory memory;
  for (int round = 0; round < 3; round++) {
    memory.clear();
    std::vector<std::span<const std::uint32_t>> copies;
    for (std::uint32_t i = 0; i < 50; i++) {
      const std::vector<std::uint32_t> values(i * 997, i);
      copies.push_back(memory.copy(std::span(values)));
    }
    for (std::uint32_t i = 0; i < 50; i++) {
      EXPECT_EQ(copies[i].size(), i * 997);
      EXPECT_TRUE(std::ranges::all_of(copies[i], [i](std::uint32_t value) { return value == i; }));
    }
  }
}

}  // namespace
}  // namespace gnomon::gpu
