// SPDX-License-Identifier: MIT
// Each edit of a scene and each setting, alone and in random order, under a live engine: the pictures are those of an
// engine that is made after the edit.
#include "unlit_engine.hh"

#include "engines/scene_edits.hh"
#include "gpu_device_fixture.hh"
#include "gpu_read.hh"
#include "render_camera.hh"

#include <gtest/gtest.h>

#include <random>
#include <string>

namespace gnomon::unlit {
namespace {

using test::EditedScene;
using test::SceneEdit;
/** Four halves each. */
using HalfPixels = std::vector<std::uint64_t>;

/** An engine that draws a scene in two viewports. */
class TwoUnlitViewports {
 public:
  TwoUnlitViewports(gpu::Device &device, const scene::Scene &scene, const Settings &settings)
      : render_scene_(device, scene),
        engine_(render_scene_, settings),
        first_(device, size_px),
        second_(device, size_px)
  {
  }
  void set_settings(const Settings &settings)
  {
    engine_.set_settings(settings);
  }
  std::pair<HalfPixels, HalfPixels> pictures()
  {
    render_scene_.update();
    return {picture(first_, test::camera_at({0, -5, 5}, {0, 0, 0.3F})),
            picture(second_, test::camera_at({4, -3, 4}, {0, 0, 0.3F}))};
  }

 private:
  static constexpr glm::ivec2 size_px{40, 28};

  HalfPixels picture(draw::Viewport &viewport, const scene::PlacedCamera &camera)
  {
    const std::array<draw::Engine *, 1> engines = {&engine_};
    viewport.sync(engines, render_scene_.objects());
    viewport.draw(engines, render_scene::view_of(camera, size_px));
    return gpu::read_as<std::uint64_t>(viewport.device(), engine_.radiance(viewport));
  }

  render_scene::RenderScene render_scene_;
  Engine engine_;
  draw::Viewport first_;
  draw::Viewport second_;
};

class UnlitSingleEditsGpu : public test::GpuDeviceTest {
 protected:
  static Settings settings()
  {
    return {.depth_size_px = {64, 64}};
  }
  void expect_as_new(TwoUnlitViewports &live, const scene::Scene &scene, const Settings &now, const std::string &after)
  {
    const auto [first, second] = live.pictures();
    const auto [expected_first, expected_second] = TwoUnlitViewports(*device, scene, now).pictures();
    EXPECT_TRUE(first == expected_first) << after << ", first viewport";
    EXPECT_TRUE(second == expected_second) << after << ", second viewport";
  }
};

TEST_F(UnlitSingleEditsGpu, OfEachPropertyAndThingGiveThePictureOfANewEngine)
{
  for (std::size_t number = 0; number < test::edited_scene_count; number++) {
    EditedScene edited = test::edited_scene(number);
    TwoUnlitViewports live(*device, edited.scene, settings());
    const auto before = live.pictures();
    for (const SceneEdit &edit : edited.edits) {
      edit.apply(edited.scene);
      expect_as_new(live, edited.scene, settings(), edit.name);
      edit.undo(edited.scene);
      if (edit.is_restored) {
        EXPECT_TRUE(live.pictures() == before) << "not " << edit.name;
      }
      else {
        expect_as_new(live, edited.scene, settings(), "not " + edit.name);
      }
    }
  }
}

TEST_F(UnlitSingleEditsGpu, InRandomOrderGiveThePictureOfANewEngine)
{
  std::mt19937 random(3);
  for (std::size_t number = 0; number < test::edited_scene_count; number++) {
    EditedScene edited = test::edited_scene(number);
    TwoUnlitViewports live(*device, edited.scene, settings());
    std::vector<bool> are_applied(edited.edits.size());
    std::string edits;
    for (int i = 0; i < 20; i++) {
      edits += test::edit_at_random(edited, are_applied, random) + "; ";
      expect_as_new(live, edited.scene, settings(), edited.name + ": " + edits);
    }
  }
}

/** All settings. A new member does not compile here: it needs edits below. */
[[maybe_unused]] void name_all(const Settings &settings)
{
  [[maybe_unused]] const auto &[depth_camera, has_shadow, depth_size_px] = settings;
}

TEST_F(UnlitSingleEditsGpu, OfEachSettingGiveThePictureOfANewEngine)
{
  const EditedScene edited = test::lamp_scene(scene::LampKind::Sun, "sun");
  TwoUnlitViewports live(*device, edited.scene, settings());
  Settings with_camera = settings();
  with_camera.depth_camera = test::camera_at({-3, -3, 4}, {0, 0, 0});
  Settings without_shadow = settings();
  without_shadow.has_shadow = false;
  Settings smaller = settings();
  smaller.depth_size_px = {16, 24};
  for (const Settings &changed : {with_camera, without_shadow, smaller}) {
    live.set_settings(changed);
    expect_as_new(live, edited.scene, changed, "a setting");
    live.set_settings(settings());
    expect_as_new(live, edited.scene, settings(), "as before");
  }
}

}  // namespace
}  // namespace gnomon::unlit
