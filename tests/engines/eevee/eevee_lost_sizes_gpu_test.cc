// SPDX-License-Identifier: MIT
// A scene whose only lamp with a size loses it, under a live renderer: the picture is that of a new renderer.
#include "eevee_scene_renderer.hh"
#include "eevee_test_scene.hh"

#include "gpu_device_fixture.hh"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

namespace gnomon::eevee {
namespace {

constexpr glm::ivec2 lost_sizes_size_px{48, 32};

/** A scene of a ground, a box and a lamp without a size, and the one thing that has a size. */
struct SizedScene {
  SizedScene()
  {
    const auto material = test::add_material(scene, glm::vec3(0.5F));
    test::add_object(scene, test::add_square_mesh(scene, material), glm::scale(glm::dmat4(1.0), glm::dvec3(4.0)));
    test::add_object(scene, test::add_box_mesh(scene, material),
                     glm::scale(glm::translate(glm::dmat4(1.0), {0, 0, 0.6}), glm::dvec3(0.5)));
    test::add_lamp(scene, scene::LampKind::Spot, {2, -2, 4}, {-2, 2, -4}, 20.0F);
    emissive = test::add_material(scene, glm::vec3(0.5F));
    glowing = test::add_object(scene, test::add_box_mesh(scene, emissive),
                               glm::scale(glm::translate(glm::dmat4(1.0), {-1.5, 0, 1}), glm::dvec3(0.2)));
  }
  void add_lamp(scene::LampKind kind, float radius, float angle)
  {
    lamp = test::add_lamp(scene, kind, {-2, -1, 3}, {2, 1, -3}, kind == scene::LampKind::Sun ? 1.0F : 20.0F);
    scene.edit(lamp, [&](scene::Lamp &value) {
      value.radius = radius;
      value.angle = angle;
    });
    node = scene.placed_lamps().back().node;
  }

  scene::Scene scene;
  scene::Handle<scene::Lamp> lamp;
  scene::Handle<scene::Node> node;
  scene::Handle<scene::Material> emissive;
  scene::Handle<scene::Node> glowing;
};

/** A way in which a scene gets a thing with a size, and one in which it loses it. */
struct Way {
  std::string name;
  std::function<void(SizedScene &)> gain;
  std::function<void(SizedScene &, Settings &)> lose;
};

std::vector<Way> ways()
{
  using scene::Lamp;
  using enum scene::LampKind;
  std::vector<Way> ways;
  const auto add_lamp = [&](std::string name, scene::LampKind kind, float radius, float angle,
                            std::function<void(SizedScene &, Settings &)> lose) {
    ways.push_back({std::move(name), [=](SizedScene &sized) { sized.add_lamp(kind, radius, angle); }, std::move(lose)});
  };
  const auto edit_lamp = [](void (*change)(Lamp &)) {
    return [change](SizedScene &sized, Settings &) { sized.scene.edit(sized.lamp, change); };
  };
  add_lamp("a sun's angle is 0", Sun, 0, 0.2F, edit_lamp([](Lamp &lamp) { lamp.angle = 0.0F; }));
  add_lamp("a point's radius is 0", Point, 0.3F, 0, edit_lamp([](Lamp &lamp) { lamp.radius = 0.0F; }));
  add_lamp("a spot's radius is 0", Spot, 0.3F, 0, edit_lamp([](Lamp &lamp) { lamp.radius = 0.0F; }));
  add_lamp("an area lamp is a point", Area, 0, 0, edit_lamp([](Lamp &lamp) { lamp.kind = Point; }));
  add_lamp("a point with a radius is a sun", Point, 0.3F, 0, edit_lamp([](Lamp &lamp) { lamp.kind = Sun; }));
  add_lamp("a sun gives no light", Sun, 0, 0.2F, edit_lamp([](Lamp &lamp) { lamp.intensity = 0.0F; }));
  add_lamp("an area lamp is black", Area, 0, 0, edit_lamp([](Lamp &lamp) { lamp.color = glm::vec3(0.0F); }));
  for (const auto &[kind, text] : {std::pair(Sun, "a sun"), {Point, "a point"}, {Spot, "a spot"}, {Area, "an area"}}) {
    const std::string name = text;
    add_lamp(name + " is removed", kind, 0.3F, 0.2F, [](SizedScene &sized, Settings &) {
      sized.scene.remove(sized.lamp);
      sized.scene.remove(sized.node);
    });
    add_lamp(name + " leaves its node", kind, 0.3F, 0.2F, [](SizedScene &sized, Settings &) {
      sized.scene.edit(sized.node, [](scene::Node &node) { node.lamp = {}; });
    });
    add_lamp(name + " is hidden", kind, 0.3F, 0.2F, [](SizedScene &sized, Settings &) {
      sized.scene.edit(sized.node, [](scene::Node &node) { node.is_visible = false; });
    });
    add_lamp(name + ": one sample", kind, 0.3F, 0.2F,
             [](SizedScene &, Settings &settings) { settings.sample_count = 1; });
  }
  const auto glow = [](SizedScene &sized) {
    sized.scene.edit(sized.emissive, [](scene::Material &material) { material.emissive = glm::vec3(1, 2, 3); });
  };
  ways.push_back({"emission is black", glow, [](SizedScene &sized, Settings &) {
                    sized.scene.edit(sized.emissive, [](scene::Material &material) { material.emissive = {}; });
                  }});
  ways.push_back(
      {"what emits is removed", glow, [](SizedScene &sized, Settings &) { sized.scene.remove(sized.glowing); }});
  ways.push_back({"what emits is hidden", glow, [](SizedScene &sized, Settings &) {
                    sized.scene.edit(sized.glowing, [](scene::Node &node) { node.is_visible = false; });
                  }});
  ways.push_back(
      {"no points of what emits", glow, [](SizedScene &, Settings &settings) { settings.emissive_point_count = 0; }});
  const auto lit_by_world = [](SizedScene &sized) {
    auto picture = std::make_shared<scene::WorldPicture>();
    picture->width = 8;
    picture->height = 4;
    picture->texels.assign(32, glm::vec3(0.1F));
    picture->texels[11] = glm::vec3(50.0F, 40.0F, 30.0F);
    sized.scene.set_world(scene::World{.picture = picture});
  };
  ways.push_back(
      {"the world is removed", lit_by_world, [](SizedScene &sized, Settings &) { sized.scene.set_world({}); }});
  ways.push_back({"the world is black", lit_by_world,
                  [](SizedScene &sized, Settings &) { sized.scene.set_world(scene::World{.strength = 0.0F}); }});
  return ways;
}

class LostSizesGpu : public test::SharedDeviceTest {
 protected:
  static Settings settings()
  {
    Settings settings{.sample_count = 4};
    settings.shadow.cube_size_px = settings.shadow.map_size_px = 64;
    return settings;
  }
  std::vector<glm::vec4> picture_of(SceneRenderer &renderer)
  {
    renderer.sync();
    renderer.draw(camera);
    return renderer.read_picture();
  }

  scene::PlacedCamera camera = test::camera_at({0, -6, 5}, {0, 0, 0.3F});
};

TEST_F(LostSizesGpu, ThePictureIsThatOfANewRenderer)
{
  for (const Way &way : ways()) {
    SizedScene sized;
    way.gain(sized);
    Settings now = settings();
    SceneRenderer live(*device, sized.scene, lost_sizes_size_px, now);
    const std::vector<glm::vec4> before = picture_of(live);
    way.lose(sized, now);
    live.set_settings(now);
    const std::vector<glm::vec4> lost = picture_of(live);
    SceneRenderer fresh(*device, sized.scene, lost_sizes_size_px, now);
    EXPECT_TRUE(lost == picture_of(fresh)) << way.name;
    EXPECT_FALSE(lost == before) << way.name << ": the thing with a size has no effect";
    EXPECT_TRUE(lost == picture_of(live)) << way.name << ", drawn again";
  }
}

/** The preview of a time budget and the picture of all samples share the scene, and each has its own points. */
TEST_F(LostSizesGpu, TwoViewportsInTurnsKeepTheirOwnPoints)
{
  SizedScene sized;
  sized.add_lamp(scene::LampKind::Area, 0, 0);
  render_scene::RenderScene shared(*device, sized.scene);
  shared.update();
  Engine engine(shared, settings());
  const std::array<draw::Engine *, 1> engines = {&engine};
  const auto view = [&] { return view_of(camera, lost_sizes_size_px); };
  draw::Viewport first(*device, lost_sizes_size_px);
  draw::Viewport second(*device, lost_sizes_size_px);
  for (draw::Viewport *viewport : {&first, &second}) {
    viewport->sync(engines, shared.objects());
  }
  for (int i = 0; i < 4; i++) {
    first.draw(engines, view());
    for (int k = 0; k <= i && i < 3; k++) {
      second.draw(engines, view());
    }
  }
  SceneRenderer fresh(*device, sized.scene, lost_sizes_size_px, settings());
  const std::vector<glm::vec4> expected = picture_of(fresh);
  EXPECT_TRUE(gpu::read_as<glm::vec4>(*device, engine.radiance(first)) == expected);
  EXPECT_TRUE(gpu::read_as<glm::vec4>(*device, engine.radiance(second)) == expected);
}

}  // namespace
}  // namespace gnomon::eevee
