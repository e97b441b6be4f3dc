// SPDX-License-Identifier: MIT
// Pictures whose pixels visit only the lamps that can reach them, on the driver: the same as if they visited all lamps.
#include "eevee_test_scene.hh"
#include "gpu_device_fixture.hh"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace gnomon::eevee {
namespace {

using test::Picture;

constexpr int never = 1 << 30;

/** Boxes on a ground in a hall of 40 m, under lamps of all kinds, most with a range. */
scene::Scene hall(int lamp_count, bool has_sizes)
{
  scene::Scene scene;
  scene::Material plain;
  plain.name = "plain";
  plain.base_color = glm::vec3(0.7F, 0.6F, 0.5F);
  plain.metallic = 0.0F;
  plain.roughness = 0.4F;
  plain.is_double_sided = true;
  const auto material = scene.add(std::move(plain));
  test::add_object(scene, test::add_square_mesh(scene, material), glm::scale(glm::dmat4(1), glm::dvec3(40)));
  const auto box = test::add_box_mesh(scene, material);
  for (int i = 0; i < 25; i++) {
    const glm::dvec3 place(7.0 * (i % 5 - 2), 7.0 * (i / 5 - 2), 0.8);
    test::add_object(scene, box, glm::scale(glm::translate(glm::dmat4(1), place), glm::dvec3(0.5, 0.7, 0.8)));
  }
  std::mt19937 random(7);
  const auto in = [&](float low, float high) { return std::uniform_real_distribution<float>(low, high)(random); };
  for (int i = 0; i < lamp_count; i++) {
    using enum scene::LampKind;
    const bool is_sun = i % 16 == 15;
    const auto kind = is_sun ? Sun : i % 16 == 14 ? Hemi : i % 16 == 13 ? Area : i % 3 == 1 ? Spot : Point;
    const bool is_dim = kind == Sun || kind == Hemi;
    const auto lamp = test::add_lamp(scene, kind, {in(-20, 20), in(-20, 20), in(1, 5)},
                                     {in(-0.5F, 0.5F), in(-0.5F, 0.5F), -1}, is_dim ? 0.05F : 20.0F);
    scene.edit(lamp, [&](scene::Lamp &value) {
      // Suns and hemis keep a range too. It means nothing.
      value.range = i % 10 == 9 ? 0.0F : in(2, 12);
      value.spot_outer_angle = in(0.2F, 1.4F);
      value.spot_blend = 0.3F;
      value.radius = has_sizes && i % 2 == 0 ? 0.2F : 0.0F;
      value.angle = has_sizes && is_sun ? 0.05F : 0.0F;
    });
  }
  return scene;
}

struct HallCase {
  const char *name;
  bool has_sizes;
  int sample_count;
  bool is_perspective;
};

class ClustersGpuTest : public test::SharedDeviceTest {
 protected:
  Picture draw(const scene::Scene &scene, const Settings &settings, bool is_perspective = true)
  {
    scene::PlacedCamera camera = test::camera_at({3, -14, 5}, {0, 2, 0});
    if (!is_perspective) {
      camera.kind = scene::CameraKind::Orthographic;
      camera.half_width = 12.0F;
      camera.half_height = 9.0F;
      camera.far = 60.0F;
    }
    test::Renderer renderer(*device, scene, {64, 48}, settings);
    renderer.draw(camera);
    report = renderer.inspect().report();
    return renderer.picture();
  }
  static Settings settings_of(int sample_count, int clustered_lamps_min)
  {
    return {.shadow = {.cube_size_px = 64, .map_size_px = 128},
            .sample_count = sample_count,
            .clustered_lamps_min = clustered_lamps_min};
  }
  [[nodiscard]] bool is_clustered() const
  {
    return find(*find(report.tree, "targets"), "light_lists")->is_made;
  }

  Report report;
};

TEST_F(ClustersGpuTest, PicturesEqualThoseOfAllLamps)
{
  for (const HallCase &one : {HallCase{"orthographic", false, 1, false},
                              {"whole lamps", true, 1, true},
                              {"points of lamps", true, 3, true}}) {
    const scene::Scene scene = hall(70, one.has_sizes);
    const Picture all = draw(scene, settings_of(one.sample_count, never), one.is_perspective);
    EXPECT_FALSE(is_clustered()) << one.name;
    const Picture clustered = draw(scene, settings_of(one.sample_count, 1), one.is_perspective);
    EXPECT_TRUE(is_clustered()) << one.name;
    EXPECT_EQ(clustered.non_finite_count(), 0U) << one.name;
    EXPECT_EQ(all.pixels, clustered.pixels) << one.name;
    const float lightest = std::ranges::max(all.pixels, {}, [](const glm::vec4 &p) { return p.r; }).r;
    EXPECT_GT(lightest, 0.1F) << one.name;
  }
}

TEST_F(ClustersGpuTest, ListsFollowTheViewAndTheLamps)
{
  scene::Scene scene = hall(40, false);
  test::Renderer renderer(*device, scene, {64, 48}, settings_of(1, 1));
  test::Renderer all(*device, scene, {64, 48}, settings_of(1, never));
  for (int i = 0; i < 4; i++) {
    const scene::PlacedCamera camera = test::camera_at({3.0F * float(i), -14, 5}, {0, 2, 0});
    EXPECT_EQ(renderer.picture(camera).pixels, all.picture(camera).pixels) << i;
    scene.edit(test::handle_at(scene.lamps(), std::size_t(3 * i)), [](scene::Lamp &lamp) { lamp.range = 20.0F; });
    renderer.sync();
    all.sync();
    EXPECT_EQ(renderer.picture(camera).pixels, all.picture(camera).pixels) << i << ", after an edit";
  }
}

TEST_F(ClustersGpuTest, APartOfAPictureEqualsThePartOfTheWhole)
{
  const scene::Scene scene = hall(70, true);
  const scene::PlacedCamera camera = test::camera_at({3, -14, 5}, {0, 2, 0});
  test::Renderer renderer(*device, scene, {64, 48}, settings_of(3, 1));
  const Picture whole = renderer.picture(camera);
  renderer.viewport.set_region({{10, 8}, {20, 30}});
  const Picture part = renderer.picture(camera);
  for (int y = 8; y < 38; y++) {
    for (int x = 10; x < 30; x++) {
      EXPECT_EQ(part.at(x, y), whole.at(x, y));
    }
  }
}

TEST_F(ClustersGpuTest, FewLampsHaveNoLists)
{
  const scene::Scene scene = hall(7, false);
  draw(scene, {.shadow = {.cube_size_px = 64, .map_size_px = 128}});
  EXPECT_FALSE(is_clustered());
  for (const std::string &name : device->live_resources()) {
    for (const char *part : {"light_texture", "light_lists", "light_cluster_block", "light_sampler"}) {
      EXPECT_EQ(name.find(part), std::string::npos) << name;
    }
  }
  EXPECT_FALSE(find(*find(report.tree, "passes"), "light_clusters")->is_made);
}

// The visibility of a lamp, which is not in light_block.
TEST_F(ClustersGpuTest, ProbesOfALampAreTheSame)
{
  const scene::Scene scene = hall(40, false);
  const scene::PlacedCamera camera = test::camera_at({3, -14, 5}, {0, 2, 0});
  for (const std::size_t lamp : {0, 1, 15, 39}) {
    std::vector<Probe> probes;
    for (const int min : {1, never}) {
      Settings settings = settings_of(1, min);
      settings.has_probe = true;
      test::Renderer renderer(*device, scene, {64, 48}, settings);
      renderer.draw(camera);
      const std::optional<Probe> probe = renderer.inspect().probe(renderer.viewport.view(), lamp);
      ASSERT_TRUE(probe);
      probes.push_back(*probe);
    }
    EXPECT_EQ(probes[0].position_visibility, probes[1].position_visibility) << lamp;
  }
}

TEST_F(ClustersGpuTest, SlowTenThousandLampsGiveAFinitePicture)
{
  const scene::Scene scene = hall(10000, false);
  const Picture picture = draw(scene, {.shadow = {.cube_size_px = 16, .map_size_px = 16, .cascades = {.count = 1}}});
  EXPECT_TRUE(is_clustered());
  EXPECT_EQ(picture.non_finite_count(), 0U);
  EXPECT_LT(device->memory_bytes(), std::size_t(64) << 20U);
  EXPECT_FALSE(report.limits.empty()) << "lamps without a shadow are named";
}

}  // namespace
}  // namespace gnomon::eevee
