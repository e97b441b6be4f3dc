// SPDX-License-Identifier: MIT
// Each operation of a frame fails once; the next frame makes again what the lost one held.
#include "frames/frames_scene.hh"

#include "shadows/shadows.hh"

#include <gtest/gtest.h>

namespace gnomon::eevee {
namespace {

using test::FramesScene;

class FrameFailure : public testing::Test {
 protected:
  std::unique_ptr<gpu::Device> make_device()
  {
    return gpu::create_null_device({}, {}, [this](std::string_view operation) {
      if (operation_count++ == failing) {
        throw gpu::Error("{} fails", operation);
      }
    });
  }

  /** Calls and commands of a picture. */
  static std::string text_of(SceneRenderer &renderer, gpu::Packet &packet)
  {
    renderer.prepare(packet, FramesScene::camera(0));
    return packet.serialize(renderer.viewport().device());
  }

  static LayerMask layers_up_to_date(SceneRenderer &renderer)
  {
    LayerMask layers = 0;
    for (const ShadowState &state : renderer.inspect().shadows().states()) {
      layers |= state.up_to_date;
    }
    return layers;
  }

  void fail_in_first_picture(int stride);

  int operation_count = 0;
  int failing = -1;
};

/** The first packet fails, by each \a stride-th of its operations: the second is that of a new renderer. */
void FrameFailure::fail_in_first_picture(int stride)
{
  std::string expected;
  int count = 0;
  {
    const auto device = make_device();
    FramesScene frames;
    SceneRenderer renderer(*device, frames.scene, {32, 24}, test::frames_settings());
    gpu::Packet packet;
    expected = text_of(renderer, packet);
    device->submit(packet);
    count = operation_count;
  }
  ASSERT_GT(count, 30);
  for (int failed = 0; failed < count; failed += stride) {
    SCOPED_TRACE(failed);
    operation_count = 0;
    failing = failed;
    const auto device = make_device();
    FramesScene frames;
    SceneRenderer renderer(*device, frames.scene, {32, 24}, test::frames_settings());
    gpu::Packet packet;
    ASSERT_EQ(text_of(renderer, packet), expected);
    EXPECT_THROW(device->submit(packet), gpu::Error);
    ASSERT_EQ(text_of(renderer, packet), expected);
    device->submit(packet);
  }
}

TEST_F(FrameFailure, AFirstPictureThatFailsIsMadeAgainInFull)
{
  fail_in_first_picture(9);
}

using SlowFrameFailure = FrameFailure;

TEST_F(SlowFrameFailure, OfEachOperationOfAFirstPicture)
{
  fail_in_first_picture(1);
}

/** A picture in between fails: everything is written and drawn again, and nothing is made twice. */
TEST_F(FrameFailure, ALaterPictureThatFailsIsDrawnAgain)
{
  for (int failed = 0; failed < 8; failed++) {
    SCOPED_TRACE(failed);
    const auto device = make_device();
    FramesScene frames;
    SceneRenderer renderer(*device, frames.scene, {32, 24}, test::frames_settings());
    renderer.sync();
    renderer.draw(FramesScene::camera(0));
    const std::vector<std::string> live = device->live_resources();
    const std::uint64_t faces = renderer.inspect().shadow_counters().faces_drawn;
    // Moves a box: some of its lamps' layers are drawn.
    frames.edit(0);
    renderer.sync();
    failing = operation_count + failed;
    EXPECT_THROW(renderer.draw(FramesScene::camera(0)), gpu::Error);
    renderer.draw(FramesScene::camera(0));
    EXPECT_EQ(device->live_resources(), live);
    // All layers of the first picture, as the lost packet may have written any.
    EXPECT_GE(renderer.inspect().shadow_counters().faces_drawn, 2 * faces);
    EXPECT_NE(layers_up_to_date(renderer), 0U);
  }
}

/** Frames of a still scene add samples until the picture is complete; an edit or a loss starts the next. */
class FrameSamples : public FrameFailure {
 protected:
  static Settings settings()
  {
    Settings settings = test::frames_settings();
    settings.sample_count = 3;
    // A wait for depths would start a picture again, too.
    settings.shadow.is_fitted_to_depth = false;
    return settings;
  }

  std::uint64_t film_passes() const
  {
    const auto found = device->pass_counts().find("film");
    return found == device->pass_counts().end() ? 0 : found->second;
  }
  /** \return whether the picture is complete */
  bool draw_frame()
  {
    const bool is_complete = renderer.prepare(packet, FramesScene::camera(0));
    device->submit(packet);
    return is_complete;
  }

  std::unique_ptr<gpu::Device> device = make_device();
  FramesScene frames;
  SceneRenderer renderer{*device, frames.scene, {32, 24}, settings()};
  gpu::Packet packet;
};

TEST_F(FrameSamples, OfAStillSceneAreDrawnOnceAndAnEditStartsAgain)
{
  EXPECT_FALSE(draw_frame());
  EXPECT_FALSE(draw_frame());
  EXPECT_TRUE(draw_frame());
  EXPECT_EQ(film_passes(), 3U);
  EXPECT_TRUE(draw_frame());
  EXPECT_EQ(film_passes(), 3U);
  frames.edit(0);
  EXPECT_FALSE(draw_frame());
  EXPECT_FALSE(draw_frame());
  EXPECT_TRUE(draw_frame());
  EXPECT_EQ(film_passes(), 6U);
}

TEST_F(FrameSamples, StartAgainWhereOneIsLost)
{
  EXPECT_FALSE(draw_frame());
  EXPECT_FALSE(draw_frame());
  failing = operation_count + 1;
  EXPECT_THROW(draw_frame(), gpu::Error);
  const std::uint64_t before = film_passes();
  EXPECT_FALSE(draw_frame());
  EXPECT_FALSE(draw_frame());
  EXPECT_TRUE(draw_frame());
  EXPECT_EQ(film_passes(), before + 3);
}

TEST_F(FrameSamples, StartAgainWhereADrawWithoutARecordingFails)
{
  renderer.sync();
  renderer.draw_sample(FramesScene::camera(0));
  failing = operation_count + 1;
  EXPECT_THROW(renderer.draw_sample(FramesScene::camera(0)), gpu::Error);
  EXPECT_EQ(renderer.viewport().samples_drawn(), 0);
  const std::uint64_t before = film_passes();
  EXPECT_TRUE(renderer.draw(FramesScene::camera(0)));
  EXPECT_EQ(film_passes(), before + 3);
}

/** Two packets in turn: the depths of the first frame come after the second, and the picture starts again with them. */
TEST_F(FrameSamples, StartAgainWithTheDepthsOfTheView)
{
  // The maps of suns with an angle are not fitted to depths.
  for (std::size_t i = 0; i < frames.scene.lamps().size(); i++) {
    frames.scene.edit(measure::handle_at(frames.scene.lamps(), i), [](scene::Lamp &lamp) { lamp.angle = 0.0F; });
  }
  Settings with_depths = settings();
  with_depths.shadow.is_fitted_to_depth = true;
  renderer.set_settings(with_depths);
  std::array<gpu::Packet, 2> packets;
  std::vector<int> samples;
  bool is_complete = false;
  for (std::size_t frame = 0; frame < 20 && !is_complete; frame++) {
    is_complete = renderer.prepare(packets[frame % 2], FramesScene::camera(0));
    samples.push_back(renderer.viewport().samples_drawn());
    if (frame > 0) {
      device->submit(packets[(frame - 1) % 2]);
    }
  }
  EXPECT_EQ(samples, std::vector<int>({1, 2, 1, 2, 3}));
  device->submit(packets[(samples.size() - 1) % 2]);
}

}  // namespace
}  // namespace gnomon::eevee
