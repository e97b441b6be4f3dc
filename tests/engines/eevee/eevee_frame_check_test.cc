// SPDX-License-Identifier: MIT
// Steps name what their command lists read and write.
#include "internal/eevee_frame_check.hh"
#include "internal/eevee_frame.hh"

#include "gpu_device.hh"

#include <gtest/gtest.h>

#include <array>
#include <span>

namespace gnomon::eevee {
namespace {

class FrameCheckTest : public testing::Test {
 protected:
  FrameCheckTest()
  {
    const std::array<float, 4> values{};
    list.update(block, 0, std::as_bytes(std::span(values)));
    list.begin_pass("draw", framebuffer, {.depth_load = gpu::LoadAction::Load});
    list.set_state(gpu::State::WriteColor);
    list.end_pass();
    lookup.begin_pass("look up", other, {});
    lookup.bind_texture(0, picture.id(), sampler.id());
    lookup.draw_procedural(3, 1);
    lookup.end_pass();
  }
  void check(const gpu::CommandList &commands, std::vector<FrameRead> reads, std::vector<std::string_view> writes)
  {
    frame_check.check({.name = "step",
                       .summary = "",
                       .part = FrameStep::Part::Each,
                       .need = {},
                       .reads = std::move(reads),
                       .writes = std::move(writes)},
                      {.settings = settings}, commands, *device);
  }

  std::unique_ptr<gpu::Device> device = gpu::create_null_device();
  gpu::Buffer block = device->create_buffer({.name = "block", .size_bytes = 16});
  gpu::Texture picture = device->create_texture({.name = "picture"});
  gpu::Texture depth = device->create_texture({.name = "depth", .format = gpu::Format::Depth32F});
  gpu::Texture result = device->create_texture({.name = "result"});
  gpu::Sampler sampler = device->create_sampler({.name = "sampler"});
  gpu::Framebuffer framebuffer = device->create_framebuffer({"framebuffer", {{&picture}}, {&depth}});
  gpu::Framebuffer other = device->create_framebuffer({"other", {{&result}}, {}});
  /** Updates the block and draws the picture, with the depth as it is. */
  gpu::CommandList list;
  /** Draws the result from the picture. */
  gpu::CommandList lookup;
  Settings settings;
  FrameCheck frame_check;
};

TEST_F(FrameCheckTest, AStepNamesTheAttachmentsAndBuffersThatItsListWrites)
{
  EXPECT_NO_THROW(check(list, {}, {"block", "picture"}));
  EXPECT_THROW(check(list, {}, {"block"}), gpu::InternalError);
  EXPECT_THROW(check(list, {}, {"picture"}), gpu::InternalError);
  EXPECT_NO_THROW(check(list, {}, {"block", "target"})) << "the attachments of a target have any names";
}

TEST_F(FrameCheckTest, AStepNamesWhatItReadsOfOtherSteps)
{
  EXPECT_NO_THROW(check(lookup, {}, {"result"})) << "no step has written the picture";
  check(list, {}, {"block", "picture"});
  EXPECT_THROW(check(lookup, {}, {"result"}), gpu::InternalError);
  EXPECT_NO_THROW(check(lookup, {"picture"}, {"result"}));
}

TEST_F(FrameCheckTest, AListThatDrawsBindsWhatItsStepNames)
{
  EXPECT_NO_THROW(check(lookup, {"picture", "block"}, {"result"})) << "no step has written the block";
  check(list, {}, {"block", "picture"});
  EXPECT_THROW(check(lookup, {"picture", "block"}, {"result"}), gpu::InternalError);
  EXPECT_NO_THROW(check(lookup, {"picture", {"block", "lights"}}, {"result"})) << "it binds nothing of the group";
  EXPECT_THROW(check(lookup, {{"picture", "lights"}, {"block", "lights"}}, {"result"}), gpu::InternalError);
  const auto read_if = [](bool is_read) {
    return FrameRead{"block", {}, [is_read](const FrameState &) { return is_read; }};
  };
  EXPECT_THROW(check(lookup, {"picture", read_if(true)}, {"result"}), gpu::InternalError);
  EXPECT_NO_THROW(check(lookup, {"picture", read_if(false)}, {"result"}));
  EXPECT_NO_THROW(check(list, {"result"}, {"block", "picture"})) << "it does not draw";
}

TEST_F(FrameCheckTest, AnAttachmentThatIsNotWrittenIsRead)
{
  gpu::CommandList clear;
  clear.begin_pass("clear", framebuffer, {.color_load = gpu::LoadAction::Load});
  clear.end_pass();
  EXPECT_THROW(check(clear, {}, {"picture"}), gpu::InternalError);
  EXPECT_NO_THROW(check(clear, {}, {"depth"}));
  EXPECT_THROW(check(list, {}, {"block", "picture"}), gpu::InternalError);
  EXPECT_NO_THROW(check(list, {"depth"}, {"block", "picture"}));
}

}  // namespace
}  // namespace gnomon::eevee
