// SPDX-License-Identifier: MIT
// One thread edits the scene and prepares frames, another submits them. scripts/test runs this program under
// ThreadSanitizer, too.
#include "frames/frames_threads.hh"
#include "frames/frames_scene.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

namespace gnomon::eevee {
namespace {

using test::FramesScene;

constexpr glm::ivec2 size_px{32, 24};

/** Hash of the calls and commands of each frame. */
std::vector<std::size_t> hashes_of(int frame_count, bool has_two_threads, gpu::Counters &counters)
{
  const auto device = gpu::create_null_device();
  FramesScene frames;
  SceneRenderer renderer(*device, frames.scene, size_px, test::frames_settings());
  std::vector<std::size_t> hashes;
  test::run_frames(
      frame_count, has_two_threads,
      [&](int frame, gpu::Packet &packet) {
        frames.edit(frame);
        renderer.prepare(packet, FramesScene::camera(frame));
        hashes.push_back(std::hash<std::string>()(packet.serialize(*device)));
      },
      [&](gpu::Packet &packet) { device->submit(packet); });
  counters = device->counters();
  return hashes;
}

void compare_threads(int frame_count)
{
  gpu::Counters one;
  gpu::Counters two;
  const std::vector<std::size_t> expected = hashes_of(frame_count, false, one);
  EXPECT_EQ(hashes_of(frame_count, true, two), expected);
  EXPECT_EQ(two.passes, one.passes);
  EXPECT_EQ(two.draws, one.draws);
  EXPECT_EQ(two.triangles, one.triangles);
  EXPECT_EQ(two.upload_bytes, one.upload_bytes);
  EXPECT_EQ(two.textures_made, one.textures_made);
  EXPECT_GT(one.passes, std::uint64_t(frame_count));
}

TEST(FrameThreads, TwoThreadsDrawWhatOneDraws)
{
  compare_threads(200);
}

TEST(SlowFrameThreads, TwoThreadsDrawWhatOneDrawsForLong)
{
  compare_threads(2000);
}

TEST(FrameThreads, LostPacketsLeaveNothingBehind)
{
  int operation_count = 0;
  int existing = 0;
  int programs = 0;
  bool is_failing = true;
  const auto device = gpu::create_null_device({}, {}, [&](std::string_view operation) {
    if (is_failing && ++operation_count % 331 == 0) {
      throw gpu::Error("{} fails", operation);
    }
    existing += operation.starts_with("create") && operation != "create batch" ? 1 : 0;
    existing -= operation.starts_with("destroy") ? 1 : 0;
    programs += operation == "create shader" ? 1 : 0;
    programs -= operation == "destroy shader" ? 1 : 0;
  });
  int lost_count = 0;
  {
    FramesScene frames;
    SceneRenderer renderer(*device, frames.scene, size_px, test::frames_settings());
    test::run_frames(
        300, true,
        [&](int frame, gpu::Packet &packet) {
          frames.edit(frame);
          renderer.prepare(packet, FramesScene::camera(frame));
        },
        [&](gpu::Packet &packet) {
          try {
            device->submit(packet);
          }
          catch (const gpu::Error & /*error*/) {
            lost_count++;
          }
        });
    // Destructors cannot report a failure.
    is_failing = false;
    const auto is_object = [](const gpu::LiveResource &resource) { return resource.kind != gpu::ResourceKind::Batch; };
    gpu::Packet last;
    // Takes note of the last losses.
    {
      const gpu::Recording recording(*device, last);
    }
    device->submit(last);
    EXPECT_EQ(existing, int(std::ranges::count_if(device->live(), is_object)));
  }
  EXPECT_GT(lost_count, 5);
  EXPECT_EQ(device->live_resources(), std::vector<std::string>());
  const gpu::Sampler next = device->create_sampler({.name = "next"});
  EXPECT_EQ(existing - programs, 1);
  // The device keeps them for the next engine.
  EXPECT_GT(programs, 0);
  EXPECT_LE(programs, int(gpu::Device::unused_shader_max));
}

}  // namespace
}  // namespace gnomon::eevee
