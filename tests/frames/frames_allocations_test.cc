// SPDX-License-Identifier: MIT
// A frame like those before it allocates nothing, neither where it is prepared nor where it is submitted.
#include "frames/frames_scene.hh"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <utility>

static std::atomic<std::uint64_t> allocation_count = 0;

static void *counted(void *memory)
{
  allocation_count++;
  return memory ? memory : throw std::bad_alloc();
}

void *operator new(std::size_t size)
{
  return counted(std::malloc(size > 0 ? size : 1));
}

// Sanitizers have one of their own, which does not call the one above.
void *operator new(std::size_t size, const std::nothrow_t & /*tag*/) noexcept
{
  allocation_count++;
  return std::malloc(size > 0 ? size : 1);
}

void *operator new(std::size_t size, std::align_val_t alignment)
{
  const auto align = std::size_t(alignment);
  return counted(std::aligned_alloc(align, (size + align - 1) / align * align));
}

// GCC would inline these beside a call of new, and warn that free() does not match it.
[[gnu::noinline]] void operator delete(void *memory) noexcept
{
  std::free(memory);
}

[[gnu::noinline]] void operator delete(void *memory, std::size_t /*size*/) noexcept
{
  std::free(memory);
}

[[gnu::noinline]] void operator delete(void *memory, std::align_val_t /*alignment*/) noexcept
{
  std::free(memory);
}

[[gnu::noinline]] void operator delete(void *memory, std::size_t /*size*/, std::align_val_t /*alignment*/) noexcept
{
  std::free(memory);
}

namespace gnomon::eevee {
namespace {

using test::FramesScene;

struct Allocations {
  std::uint64_t prepare = 0;
  std::uint64_t submit = 0;
};

class FrameAllocations : public testing::Test {
 protected:
  static constexpr int frame_count = 32;

  FrameAllocations()
  {
    // Casters far away, so that one map for all of them is coarse, and cascades follow the camera.
    const auto mesh = measure::add_box_mesh(frames.scene, measure::add_material(frames.scene, glm::vec3(0.5F)));
    for (int i = 0; i < 16; i++) {
      const glm::dvec3 place(40.0 * (i % 4) - 60.0, 40.0 * (i / 4) - 60.0, 1.0);
      measure::add_object(frames.scene, mesh, glm::translate(glm::dmat4(1.0), place));
    }
  }

  /**
   * Counts the allocations of \a frame_count frames after two rounds of as many. Each writes the picture and its depth
   * to a target. The first round begins without shadows. The second begins with those of the last frame, as all later
   * rounds, and so draws cascades in other combinations, each with a framebuffer.
   */
  template <typename Camera>
  Allocations of_third_round(const Settings &settings, Camera &&camera)
  {
    SceneRenderer renderer(*device, frames.scene, {32, 24}, settings);
    const gpu::Texture color = device->create_texture({.name = "color", .width = 32, .height = 24});
    const gpu::Texture depth =
        device->create_texture({.name = "depth", .format = gpu::Format::Depth32F, .width = 32, .height = 24});
    const gpu::Framebuffer framebuffer =
        device->create_framebuffer({.name = "target", .colors = {{&color}}, .depth = {&depth}});
    const draw::Target target{.framebuffer = &framebuffer,
                              .depth = draw::HostDepth{.clip_from_view = draw::perspective(1.0F, 1.0F, 0.1F, 100.0F)}};
    Allocations counts;
    std::uint64_t faces_before = 0;
    for (int round = 0; round < 3; round++) {
      counts = {};
      for (int frame = 0; frame < frame_count; frame++) {
        gpu::Packet &packet = packets[std::size_t(frame % 2)];
        const scene::PlacedCamera of_frame = camera(frame);
        const std::uint64_t before = allocation_count;
        if (frame % settings.sample_count == 0) {
          renderer.viewport().restart();
        }
        renderer.prepare(packet, of_frame, target);
        const std::uint64_t prepared = allocation_count;
        device->submit(packet);
        counts.prepare += prepared - before;
        counts.submit += allocation_count - prepared;
      }
      const std::uint64_t faces = renderer.inspect().shadow_counters().faces_drawn;
      faces_drawn = faces - std::exchange(faces_before, faces);
      EXPECT_TRUE(round > 0 || counts.prepare > 100U) << "nothing is counted";
    }
    return counts;
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  FramesScene frames;
  std::array<gpu::Packet, 2> packets;
  /** In the third round. */
  std::uint64_t faces_drawn = 0;
};

/** Several samples: lamps with a size have another shadow in each. */
TEST_F(FrameAllocations, AStillSceneAllocatesNothing)
{
  const Allocations counts = of_third_round({.sample_count = 4}, [](int /*frame*/) { return FramesScene::camera(0); });
  EXPECT_EQ(counts.prepare, 0U);
  EXPECT_EQ(counts.submit, 0U);
}

TEST_F(FrameAllocations, AMovingCameraAllocatesNothing)
{
  const Allocations counts =
      of_third_round({.shadow = {.cube_size_px = 32, .map_size_px = 64, .cascades = {.count = 4}}},
                     [](int frame) { return FramesScene::camera(frame, frame_count); });
  EXPECT_EQ(counts.prepare, 0U);
  EXPECT_EQ(counts.submit, 0U);
  EXPECT_GT(faces_drawn, 0U) << "cascades follow the camera";
}

/** Pixels visit the lamps in lists that follow the view. */
TEST_F(FrameAllocations, AMovingCameraBelowManyLampsAllocatesNothing)
{
  for (int i = 0; i < 40; i++) {
    const glm::vec3 place(8.0F * float(i % 8) - 28.0F, 8.0F * float(i / 8) - 16.0F, 3.0F);
    const auto lamp = measure::add_lamp(frames.scene, scene::LampKind::Point, place, {0, 0, -1}, 10.0F);
    frames.scene.edit(lamp, [](scene::Lamp &value) {
      value.range = 6.0F;
      value.shadow.kind = scene::ShadowKind::None;
    });
  }
  for (const int sample_count : {1, 4}) {
    const Allocations counts =
        of_third_round({.shadow = {.cube_size_px = 32, .map_size_px = 64}, .sample_count = sample_count},
                       [&](int frame) { return FramesScene::camera(frame - frame % sample_count, frame_count); });
    EXPECT_EQ(counts.prepare, 0U) << sample_count;
    EXPECT_EQ(counts.submit, 0U) << sample_count;
  }
}

/** Storage of a new recording grows by a factor, not with each object. */
TEST_F(FrameAllocations, APictureAfterAChangeOfSettingsAllocatesNothingForEachObject)
{
  std::vector<std::uint64_t> counts;
  for (const int object_count : {100, 1600}) {
    FramesScene many;
    const auto mesh = measure::add_box_mesh(many.scene, measure::add_material(many.scene, glm::vec3(0.5F)));
    for (int i = 0; i < object_count; i++) {
      measure::add_object(many.scene, mesh,
                          glm::translate(glm::dmat4(1.0), glm::dvec3(0.01 * i - 8.0, 0.1 * (i % 7), 0.5)));
    }
    Settings settings{.shadow = {.cube_size_px = 32, .map_size_px = 64}};
    SceneRenderer renderer(*device, many.scene, {32, 24}, settings);
    std::uint64_t before = 0;
    for (int picture = 0; picture < 3; picture++) {
      settings.light_threshold = 1e-6F * float(picture + 1);
      renderer.set_settings(settings);
      before = allocation_count;
      renderer.prepare(packets[0], FramesScene::camera(0));
      before = allocation_count - before;
      device->submit(packets[0]);
    }
    counts.push_back(before);
  }
  // Sixteen times as many objects: an array that is not reserved grows four times more.
  EXPECT_LT(counts[1], counts[0] + 32U);
}

}  // namespace
}  // namespace gnomon::eevee
