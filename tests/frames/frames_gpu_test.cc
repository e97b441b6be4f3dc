// SPDX-License-Identifier: MIT
#include "frames/frames_failures.hh"
#include "gpu/gpu_gl_hook.hh"
#include "gpu_device_fixture.hh"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace gnomon::eevee {
namespace {

using test::Bytes;
using test::FailingAllocation;
using test::FramesScene;
using test::fresh_picture;
using Frames = test::SharedDeviceTest;
/** With a driver of OpenGL that fails on demand. */
using GlFrames = test::GlDeviceTest;

/** The picture of each frame. */
std::vector<Bytes> pictures_of(gpu::Device &device, int frame_count, bool has_two_threads)
{
  FramesScene frames;
  SceneRenderer renderer(device, frames.scene, test::frames_size_px, test::frames_settings());
  const std::array<draw::Engine *, 1> engines = {&renderer.engine()};
  std::vector<Bytes> pictures;
  constexpr std::uint64_t tag = 1000;
  test::run_frames(
      frame_count, has_two_threads,
      [&](int frame, gpu::Packet &packet) {
        renderer.viewport().take_feedback(engines, packet.feedback());
        const gpu::Recording recording(device, packet);
        frames.edit(frame);
        renderer.sync();
        renderer.draw_sample(FramesScene::camera(frame, 12));
        device.read_back(renderer.engine().radiance(renderer.viewport()), 0, tag);
      },
      [&](gpu::Packet &packet) {
        device.submit(packet);
        pictures.push_back(std::ranges::find(packet.feedback().texels, tag, &gpu::Feedback::Texels::tag)->bytes);
      });
  return pictures;
}

TEST_F(Frames, OfTwoThreadsAreThoseOfOne)
{
  constexpr int frame_count = 20;
  const std::vector<Bytes> expected = pictures_of(*device, frame_count, false);
  EXPECT_NE(expected[0], expected[1]);
  EXPECT_EQ(pictures_of(*device, frame_count, true), expected);
}

/** glGetError reports this many calls without an error, then that memory is out, once; negative: never. */
int calls_until_error = -1;

TEST_F(GlFrames, ThatFailAreFollowedByTheRightPicture)
{
  const std::array<Bytes, 2> expected = {fresh_picture(*device, 1), fresh_picture(*device, 2)};
  const test::Hook hook(
      epoxy_glGetError,
      +[]() -> GLenum { return calls_until_error >= 0 && calls_until_error-- == 0 ? GL_OUT_OF_MEMORY : GL_NO_ERROR; });
  int failure_count = 0;
  for (const int calls : {0, 5, 20}) {
    SCOPED_TRACE(calls);
    FramesScene frames;
    SceneRenderer renderer(*device, frames.scene, test::frames_size_px, test::frames_settings());
    frames.edit(0);
    const auto draw = [&] {
      renderer.sync();
      renderer.draw(FramesScene::camera(0));
    };
    const auto draw_after_failure = [&] {
      calls_until_error = calls;
      try {
        draw();
      }
      catch (const gpu::Error & /*error*/) {
        failure_count++;
      }
      calls_until_error = -1;
      draw();
      return device->read(renderer.engine().radiance(renderer.viewport()));
    };
    EXPECT_EQ(draw_after_failure(), expected[0]);
    frames.edit(1);
    EXPECT_EQ(draw_after_failure(), expected[1]);
  }
  EXPECT_GT(failure_count, 3);
}

/** Each allocation of a buffer or texture fails once, in a first picture with lamps and shadows of all kinds. */
TEST_F(GlFrames, WhoseAllocationsFailOneAtATimeAreFollowedByTheRightPicture)
{
  // Afterwards the function pointers are those of the driver, and the device has the programs.
  const Bytes expected = fresh_picture(*device, 1);
  static const auto buffer_data = epoxy_glBufferData;
  static const auto texture_2d = epoxy_glTextureStorage2D;
  static const auto texture_3d = epoxy_glTextureStorage3D;
  static const auto get_error = epoxy_glGetError;
  const test::Hook buffers(
      epoxy_glBufferData, +[](GLenum target, GLsizeiptr size, const void *data, GLenum usage) {
        FailingAllocation::fails() ? void() : buffer_data(target, size, data, usage);
      });
  const test::Hook flat(
      epoxy_glTextureStorage2D, +[](GLuint texture, GLsizei levels, GLenum format, GLsizei width, GLsizei height) {
        FailingAllocation::fails() ? void() : texture_2d(texture, levels, format, width, height);
      });
  const test::Hook layered(
      epoxy_glTextureStorage3D,
      +[](GLuint texture, GLsizei levels, GLenum format, GLsizei width, GLsizei height, GLsizei layers) {
        FailingAllocation::fails() ? void() : texture_3d(texture, levels, format, width, height, layers);
      });
  const test::Hook errors(
      epoxy_glGetError, +[]() -> GLenum {
        return std::exchange(FailingAllocation::is_out_of_memory, false) ? GLenum(GL_OUT_OF_MEMORY) : get_error();
      });
  test::expect_pictures_after_each_failed_allocation(*device, expected);
}

}  // namespace
}  // namespace gnomon::eevee
